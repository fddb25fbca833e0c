// Takes pictures of meshes, for the demonstration and the documentation:
//
//     tufa_render -o OUT.png [--size 900x700] MESH[:key=value,...]...
//
// Each mesh becomes one picture; they stand side by side. Keys: azimuth, elevation (degrees), width
// (world units, 0 fits), x, y, z (the centre if width is given); 0 or 1: edges, smooth, yup. A
// folder of chunks is drawn with colours for its LODs: 0 within `step` world units of (eyex, eyey,
// eyez), 1 within two steps, 2 within four, and so on.

#include <tufa/io.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "chunk_scene.h"
#include "scene.h"

namespace {

using tufa::render::Image;
using tufa::render::View;

struct Panel {
  std::string path;
  View view;
  tufa::Position eye{0, 0, 0};
  double step = 1;
};

struct Arguments {
  std::string output;
  int width = 900;
  int height = 700;
  std::vector<Panel> panels;
};

void setKey(Panel& panel, const std::string& key, double value) {
  View& view = panel.view;
  const std::map<std::string, double*> numbers = {
      {"azimuth", &view.azimuth}, {"elevation", &view.elevation}, {"width", &view.width},
      {"x", &view.centre[0]},     {"y", &view.centre[1]},         {"z", &view.centre[2]},
      {"eyex", &panel.eye.x},     {"eyey", &panel.eye.y},         {"eyez", &panel.eye.z},
      {"step", &panel.step}};
  const std::map<std::string, bool*> switches = {
      {"edges", &view.edges}, {"smooth", &view.smooth}, {"yup", &view.yUp}};
  if (numbers.count(key) != 0) {
    *numbers.at(key) = value;
  } else if (switches.count(key) != 0) {
    *switches.at(key) = value != 0;
  } else {
    throw std::runtime_error("unknown key " + key);
  }
}

Panel panelOf(const std::string& path) {
  Panel panel;
  panel.path = path;
  return panel;
}

Panel parsePanel(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || text.find('=', colon) == std::string::npos)
    return panelOf(text);
  Panel panel = panelOf(text.substr(0, colon));
  std::istringstream list(text.substr(colon + 1));
  for (std::string item; std::getline(list, item, ',');) {
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos) throw std::runtime_error("not key=value: " + item);
    setKey(panel, item.substr(0, equals), std::stod(item.substr(equals + 1)));
  }
  return panel;
}

Arguments parse(const std::vector<std::string>& words) {
  Arguments arguments;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool last = i + 1 == words.size();
    if (words[i] == "-o" && !last) {
      arguments.output = words[++i];
    } else if (words[i] == "--size" && !last) {
      if (std::sscanf(words[++i].c_str(), "%dx%d", &arguments.width, &arguments.height) != 2) {
        throw std::runtime_error("--size takes WIDTHxHEIGHT");
      }
    } else {
      arguments.panels.push_back(parsePanel(words[i]));
    }
  }
  if (arguments.output.empty() || arguments.panels.empty() || arguments.width < 1 ||
      arguments.height < 1) {
    throw std::runtime_error(
        "usage: tufa_render -o OUT.png [--size 900x700] MESH[:key=value,...]...");
  }
  return arguments;
}

Image imageOf(const Panel& panel, const Arguments& arguments) {
  if (!std::filesystem::is_directory(panel.path)) {
    return render(tufa::readMesh(panel.path), panel.view, arguments.width, arguments.height);
  }
  const auto scene = tufa::render::readChunkScene(panel.path, panel.eye, panel.step);
  View view = panel.view;
  view.colors = scene.colors;
  return render(scene.mesh, view, arguments.width, arguments.height);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Arguments arguments = parse({argv + 1, argv + argc});
    std::vector<Image> images;
    for (const Panel& panel : arguments.panels) {
      images.push_back(imageOf(panel, arguments));
    }
    writePng(sideBySide(images, 6, {1, 1, 1}), arguments.output);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tufa_render: %s\n", error.what());
    return 1;
  }
  return 0;
}
