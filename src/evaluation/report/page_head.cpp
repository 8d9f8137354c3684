#include "evaluation/report/page_head.hpp"

#include <fmt/format.h>

extern const char* const kReportCss;  // data/report/report.css

namespace tubebin::evaluation {

std::string page_head(const char* title, const std::string& further_style) {
  return fmt::format(R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{}</title>
<style>
{}{}</style>
</head>
<body>
)html",
                     title, kReportCss, further_style);
}

}  // namespace tubebin::evaluation
