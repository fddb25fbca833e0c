#include "html.h"

namespace tufa::tools {
namespace {

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

std::string row(const std::string& cell, const std::vector<std::string>& texts) {
  std::string cells;
  for (const std::string& text : texts) cells += element(cell, escaped(text));
  return element("tr", cells) + "\n";
}

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:1500px;padding:0 1rem;"
    "color:#1c2530;background:#fff}"
    "h1{font-size:1.5rem;margin:0}h2{font-size:1.1rem;margin:2rem 0 .3rem}p{margin:.3rem 0}"
    "table{border-collapse:collapse;margin:1rem 0}"
    "th,td{text-align:right;padding:.25rem .9rem;border-bottom:1px solid #d8dee6;"
    "font-variant-numeric:tabular-nums}th{font-weight:600}"
    ".row{display:grid;grid-template-columns:repeat(3,1fr);gap:.6rem}"
    "figure{margin:0}img{width:100%;display:block;border-radius:4px}"
    "figcaption,.legend{font-size:.85rem;color:#4a5868}"
    ".legend{text-align:right}"
    ".legend span{display:inline-block;width:9rem;height:.7rem;vertical-align:middle;"
    "border-radius:2px}";

}  // namespace

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '&':
        safe += "&amp;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string element(const std::string& tag, const std::string& content) {
  return "<" + tag + ">" + content + "</" + tag.substr(0, tag.find(' ')) + ">";
}

std::string figure(const render::Image& image, const std::string& caption) {
  return "<figure><img alt=\"" + escaped(caption) + "\" src=\"data:image/png;base64," +
         base64(render::pngOf(image)) + "\">" + element("figcaption", escaped(caption)) +
         "</figure>\n";
}

std::string table(const std::vector<std::string>& headings,
                  const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<table>\n" + row("th", headings);
  for (const auto& texts : rows) html += row("td", texts);
  return html + "</table>\n";
}

std::string pageHead(const std::string& title, const std::string& summary) {
  std::string html = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">";
  html += element("title", escaped(title)) + element("style", kStyle) + "</head><body>\n";
  return html + element("h1", escaped(title)) + "\n" + element("p", escaped(summary)) + "\n";
}

std::string pageEnd() { return "</body></html>\n"; }

}  // namespace tufa::tools
