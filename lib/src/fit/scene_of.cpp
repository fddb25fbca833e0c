#include <tufa/fit.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace tufa {

std::string sceneOf(const BlobFit& fit) {
  nlohmann::ordered_json balls = nlohmann::ordered_json::array();
  for (const Blob& blob : fit.blobs) {
    balls.push_back({{"center", {blob.centre.x, blob.centre.y, blob.centre.z}},
                     {"radius", blob.radius},
                     {"weight", blob.weight}});
  }
  const nlohmann::ordered_json scene = {{"tufa_scene", 1},
                                        {"objects",
                                         {{{"type", "metaballs"},
                                           {"kernel", "blinn"},
                                           {"blobbiness", fit.blobbiness},
                                           {"threshold", fit.threshold},
                                           {"balls", std::move(balls)}}}}};
  return scene.dump(1) + "\n";
}

}  // namespace tufa
