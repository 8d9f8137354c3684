#include "tubebin/evaluation/table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tubebin::evaluation {
namespace {

/// Columns on a terminal: characters, not bytes, of a UTF-8 text.
std::size_t shown_width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool to_the_right) {
  const std::string space(width - std::min(width, shown_width(text)), ' ');
  return to_the_right ? space + text : text + space;
}

/// A column of numbers stands to the right.
std::vector<bool> numeric_columns(const Table& table) {
  std::vector<bool> numeric(table.headers.size(), true);
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i)
      if (!row[i].value && !row[i].text.empty()) numeric[i] = false;
  return numeric;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  quoted += '"';
  return quoted;
}

std::string markdown_field(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

}  // namespace

Cell integer_cell(long long value) { return {fmt::format("{}", value), static_cast<double>(value)}; }

Cell number_cell(double value, int decimals) { return {fmt::format("{:.{}f}", value, decimals), value}; }

std::string count_of_tubes(int count) { return fmt::format("{} tube{}", count, count == 1 ? "" : "s"); }

Cell percent_cell(double share, int decimals) { return {fmt::format("{:.{}f} %", 100.0 * share, decimals), share}; }

Table transpose(const Table& table, std::size_t name_columns) {
  Table result{table.title, {""}, {}, table.note};
  for (const auto& row : table.rows) {
    std::string name;
    for (std::size_t i = 0; i < name_columns; ++i) name.append(name.empty() ? "" : " ").append(row[i].text);
    result.headers.push_back(std::move(name));
  }
  for (std::size_t i = name_columns; i < table.headers.size(); ++i) {
    std::vector<Cell> row = {table.headers[i]};
    for (const auto& cells : table.rows) row.push_back(i < cells.size() ? cells[i] : Cell());
    result.rows.push_back(std::move(row));
  }
  return result;
}

std::string format_text(const Table& table) {
  const std::vector<bool> numeric = numeric_columns(table);
  std::vector<std::size_t> widths;
  for (const std::string& header : table.headers) widths.push_back(shown_width(header));
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], shown_width(row[i].text));

  const auto line = [&](const auto& text_of) {
    std::string text;
    for (std::size_t i = 0; i < widths.size(); ++i)
      text.append(i > 0 ? "  " : "").append(padded(text_of(i), widths[i], numeric[i]));
    return text.erase(text.find_last_not_of(' ') + 1) + "\n";
  };
  std::string text = table.title + "\n" + line([&](std::size_t i) { return table.headers[i]; });
  text += line([&](std::size_t i) { return std::string(widths[i], '-'); });
  for (const auto& row : table.rows) text += line([&](std::size_t i) { return i < row.size() ? row[i].text : ""; });
  if (!table.note.empty()) text += table.note + "\n";
  return text;
}

std::string format_markdown(const Table& table) {
  const std::vector<bool> numeric = numeric_columns(table);
  std::string text = fmt::format("**{}**\n\n|", table.title);
  for (const std::string& header : table.headers) text += fmt::format(" {} |", markdown_field(header));
  text += "\n|";
  for (const bool is_numeric : numeric) text += is_numeric ? " ---: |" : " --- |";
  text += "\n";
  for (const auto& row : table.rows) {
    text += "|";
    for (const Cell& cell : row) text += fmt::format(" {} |", markdown_field(cell.text));
    text += "\n";
  }
  if (!table.note.empty()) text += "\n" + table.note + "\n";
  return text;
}

std::string format_csv(const Table& table) {
  std::string text;
  for (std::size_t i = 0; i < table.headers.size(); ++i)
    text.append(i > 0 ? "," : "").append(csv_field(table.headers[i]));
  text += "\n";
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      text.append(i > 0 ? "," : "").append(row[i].value ? fmt::format("{}", *row[i].value) : csv_field(row[i].text));
    text += "\n";
  }
  return text;
}

std::string escape_html(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string format_html(const Table& table) {
  const std::vector<bool> numeric = numeric_columns(table);
  std::string text = fmt::format(
      "<div class=\"table\" role=\"region\" tabindex=\"0\" aria-label=\"{0}\"><table><caption>{0}</caption><thead><tr>",
      escape_html(table.title));
  for (std::size_t i = 0; i < table.headers.size(); ++i)  // a header without words would be read out as one
    text += table.headers[i].empty() ? "<td></td>"
                                     : fmt::format("<th scope=\"col\"{}>{}</th>", numeric[i] ? " class=\"number\"" : "",
                                                   escape_html(table.headers[i]));
  text += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    text += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      text += fmt::format("<td{}>{}</td>", numeric[i] ? " class=\"number\"" : "", escape_html(row[i].text));
    text += "</tr>\n";
  }
  text += "</tbody></table>";
  if (!table.note.empty()) text += fmt::format("<p class=\"note\">{}</p>", escape_html(table.note));
  return text + "</div>\n";
}

}  // namespace tubebin::evaluation
