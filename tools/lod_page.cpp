#include "lod_page.h"

#include <tufa/check.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "console.h"
#include "render/scene.h"

namespace tufa::tools {
namespace {

using render::Color;
using render::Image;
using render::View;

constexpr int kWidth = 640;
constexpr int kHeight = 480;

// Colours of the error map from no error to the largest, evenly spaced.
constexpr std::array<Color, 4> kRamp = {Color{0.75F, 0.80F, 0.85F},
                                        {0.95F, 0.80F, 0.25F},
                                        {0.85F, 0.25F, 0.08F},
                                        {0.25F, 0.01F, 0.05F}};

Color rampAt(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * (kRamp.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), kRamp.size() - 2);
  const auto blend = static_cast<float>(place - static_cast<double>(i));
  Color color;
  for (std::size_t k = 0; k < 3; ++k) {
    color[k] = kRamp[i][k] + blend * (kRamp[i + 1][k] - kRamp[i][k]);
  }
  return color;
}

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
  return "<" + tag + ">" + content + "</" + tag + ">";
}

std::string figure(const Image& image, const std::string& caption) {
  return "<figure><img alt=\"" + escaped(caption) + "\" src=\"data:image/png;base64," +
         base64(render::pngOf(image)) + "\">" + element("figcaption", escaped(caption)) +
         "</figure>\n";
}

std::string row(const std::string& cell, const std::vector<std::string>& texts) {
  std::string cells;
  for (const std::string& text : texts) cells += element(cell, escaped(text));
  return element("tr", cells) + "\n";
}

/// The ramp as a bar, from 0 to the largest error.
std::string legend(const std::string& largest) {
  std::string stops;
  for (std::size_t i = 0; i <= 12; ++i) {
    const Color color = rampAt(static_cast<double>(i) / 12);
    char text[32];
    std::snprintf(text, sizeof text, "%s#%02lx%02lx%02lx", i > 0 ? "," : "",
                  std::lround(255 * std::pow(color[0], 1 / 2.2F)),
                  std::lround(255 * std::pow(color[1], 1 / 2.2F)),
                  std::lround(255 * std::pow(color[2], 1 / 2.2F)));
    stops += text;
  }
  return "<p class=\"legend\">0 <span style=\"background:linear-gradient(90deg," + stops +
         ")\"></span> " + escaped(largest) + "</p>\n";
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

/// Rendering has no progress of its own: checks for cancellation between pictures.
void report(const LodPage& page, std::size_t done, std::size_t all) {
  if (!page.progress) return;
  if (!page.progress("pictures", static_cast<double>(done) / static_cast<double>(all))) {
    throw Error(ErrorCode::Cancelled, "cancelled while taking pictures");
  }
}

std::string levelSection(const LodChain& chain, std::size_t level, const Mesh& reference,
                         const LodPage& page, const View& view) {
  const Lod& lod = chain.levels[level];
  const double largest = lod.certificate.maxErrorWorld;
  View wires = view;
  wires.edges = true;
  wires.smooth = false;
  View errors = view;
  errors.colors = [&](const std::vector<Position>& points) {
    DistanceOptions options;
    options.threads = page.threads;
    std::vector<Color> colors;
    for (const double distance : distancesTo(reference, points, options)) {
      colors.push_back(rampAt(largest > 0 ? distance / largest : 0));
    }
    return colors;
  };
  std::string html = element("h2", "Level " + std::to_string(level) + ": " +
                                       formatCount(lod.mesh.triangleCount()) + " triangles");
  html += "<div class=\"row\">\n";
  html += figure(render::render(lod.mesh, view, kWidth, kHeight), "surface");
  html += figure(render::render(lod.mesh, wires, kWidth, kHeight), "triangles");
  html += figure(render::render(lod.mesh, errors, kWidth, kHeight), "distance to the uniform mesh");
  html += "</div>\n";
  return html +
         legend(shortNumber(lod.certificate.maxErrorVoxels) + " voxels, the certified error");
}

}  // namespace

void writeLodPage(const LodChain& chain, const Mesh& reference, const LodPage& page,
                  const std::filesystem::path& path) {
  View view;
  view.yUp = page.yUp;
  view = render::fitted(chain.levels.front().mesh, view, kWidth, kHeight);
  std::string html = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">";
  html += element("title", escaped(page.title)) + element("style", kStyle) + "</head><body>\n";
  html += element("h1", escaped(page.title)) + "\n" + element("p", escaped(page.summary)) + "\n";
  html += "<table>\n" + row("th", page.headings);
  for (const auto& texts : page.rows) html += row("td", texts);
  html += "</table>\n";
  for (std::size_t level = 0; level < chain.levels.size(); ++level) {
    report(page, level, chain.levels.size());
    html += levelSection(chain, level, reference, page, view);
  }
  report(page, chain.levels.size(), chain.levels.size());
  writeFile(html + "</body></html>\n", path);
}

}  // namespace tufa::tools
