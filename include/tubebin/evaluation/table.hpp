/// Tables for people and for programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tubebin::evaluation {

/// What a table shows, and what a program reads.
struct Cell {
  Cell() = default;
  Cell(std::string shown) : text(std::move(shown)) {}  // NOLINT: a text is a cell
  Cell(const char* shown) : text(shown) {}             // NOLINT
  Cell(std::string shown, double exact) : text(std::move(shown)), value(exact) {}

  std::string text;             ///< empty: nothing to show
  std::optional<double> value;  ///< unrounded, for numbers
};

struct Table {
  std::string title;
  std::vector<std::string> headers;
  std::vector<std::vector<Cell>> rows;
  std::string note;  ///< shown below; may be empty
};

/// A whole number.
Cell integer_cell(long long value);
/// With so many decimals.
Cell number_cell(double value, int decimals);
/// "1 tube", "5 tubes".
std::string count_of_tubes(int count);
/// A share of one in per cent.
Cell percent_cell(double share, int decimals = 1);

/// The table with its rows as columns: the first `name_columns` cells of a row together become the column's
/// header.
Table transpose(const Table& table, std::size_t name_columns);

/// Aligned columns for a terminal, numbers to the right.
std::string format_text(const Table& table);
std::string format_markdown(const Table& table);
/// One line of headers, one a row; exact values (RFC 4180).
std::string format_csv(const Table& table);
/// `<table>` with a `<caption>`; everything escaped.
std::string format_html(const Table& table);

/// For element content and attribute values.
std::string escape_html(const std::string& text);

}  // namespace tubebin::evaluation
