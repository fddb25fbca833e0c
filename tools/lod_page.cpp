#include "lod_page.h"

#include <tufa/check.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "console.h"
#include "html.h"
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

/// Takes the pictures of a page. Rendering has no progress of its own: whether to go on is asked
/// before each.
class Photographer {
 public:
  Photographer(const LodPage& page, std::size_t levels) : page_(page), all_(kOfLevel * levels) {}

  std::string figureOf(const Mesh& mesh, const View& view, const std::string& caption) {
    report();
    ++done_;
    return figure(render::render(mesh, view, kWidth, kHeight), caption);
  }

  void report() const {
    if (!page_.progress) return;
    if (!page_.progress("pictures", static_cast<double>(done_) / static_cast<double>(all_))) {
      throw Error(ErrorCode::Cancelled, "cancelled while taking pictures");
    }
  }

 private:
  static constexpr std::size_t kOfLevel = 3;

  const LodPage& page_;
  std::size_t all_;
  std::size_t done_ = 0;
};

std::string levelSection(const LodChain& chain, std::size_t level, const Mesh& reference,
                         const LodPage& page, const View& view, Photographer& photographer) {
  const Lod& lod = chain.levels[level];
  const double largest = lod.certificate.maxErrorWorld;
  View wires = view;
  wires.edges = true;
  wires.smooth = false;
  View errors = view;
  errors.colors = [&](const std::vector<Position>& points) {
    DistanceOptions options;
    options.threads = page.threads;
    options.progress = [&](std::string_view /*stage*/, double /*fraction*/) {
      photographer.report();
      return true;
    };
    std::vector<Color> colors;
    for (const double distance : distancesTo(reference, points, options)) {
      colors.push_back(rampAt(largest > 0 ? distance / largest : 0));
    }
    return colors;
  };
  std::string html = element("h2", "Level " + std::to_string(level) + ": " +
                                       formatCount(lod.mesh.triangleCount()) + " triangles");
  html += "<div class=\"row\">\n";
  html += photographer.figureOf(lod.mesh, view, "surface");
  html += photographer.figureOf(lod.mesh, wires, "triangles");
  html += photographer.figureOf(lod.mesh, errors, "distance to the uniform mesh");
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
  std::string html = pageHead(page.title, page.summary) + table(page.headings, page.rows);
  Photographer photographer(page, chain.levels.size());
  for (std::size_t level = 0; level < chain.levels.size(); ++level) {
    html += levelSection(chain, level, reference, page, view, photographer);
  }
  photographer.report();
  writeFile(html + pageEnd(), path);
}

}  // namespace tufa::tools
