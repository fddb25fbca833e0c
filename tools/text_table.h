#pragma once

#include <string>
#include <vector>

namespace tufa::tools {

/// Rows of a table, the first of which has the headings.
using TableRows = std::vector<std::vector<std::string>>;

/// Columns as wide as their widest cell, each cell to the right.
[[nodiscard]] std::string layOut(const TableRows& rows);

/// The same as a table of Markdown.
[[nodiscard]] std::string markdownOf(const TableRows& rows);

}  // namespace tufa::tools
