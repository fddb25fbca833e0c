#pragma once

#include <string>
#include <vector>

#include "render/image.h"

namespace tufa::tools {

// Pieces of pages of HTML that need no other file.

/// Text in which nothing is markup.
[[nodiscard]] std::string escaped(const std::string& text);

/// An element of a page around markup; `tag` may hold attributes.
[[nodiscard]] std::string element(const std::string& tag, const std::string& content);

/// A picture with text below it.
[[nodiscard]] std::string figure(const render::Image& image, const std::string& caption);

/// A table of texts.
[[nodiscard]] std::string table(const std::vector<std::string>& headings,
                                const std::vector<std::vector<std::string>>& rows);

/// All up to the end of the first paragraph, of which the text is `summary`.
[[nodiscard]] std::string pageHead(const std::string& title, const std::string& summary);

/// What ends a page.
[[nodiscard]] std::string pageEnd();

}  // namespace tufa::tools
