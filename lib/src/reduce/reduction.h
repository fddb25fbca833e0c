#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/job.h"
#include "base/shared_array.h"
#include "reduce/certificate.h"
#include "reduce/operations.h"
#include "reduce/partition.h"
#include "reduce/proxy.h"
#include "reduce/reference_mesh.h"
#include "reduce/replace_parts.h"
#include "reduce/surface.h"

namespace tufa::reduce {

class Part;

/// Voxels; what is less is near the rounding of positions.
inline constexpr float kLeastTolerance = 1e-3f;

/// A mesh as it comes in. Positions are in voxels, counted from a place in the middle of the mesh,
/// so that single precision is enough.
struct InputMesh {
  base::SharedArray<Vec3f> positions;
  base::TriangleArray triangles;
};

/// The reduced mesh.
struct ReducedMesh {
  std::vector<Vec3f> positions;  ///< voxels, as those of the input
  std::vector<Triangle> triangles;
  /// For each position the input's vertex that it still is, or kNone if it was placed anew.
  std::vector<Index> sources;
  /// For each position the face of the reference below it.
  std::vector<Index> faces;
  std::vector<Index> regions;  ///< of each triangle; empty without regions
};

struct Options {
  PartSize partSize;      ///< the result depends on it
  float leastAngle = 10;  ///< degrees under which a triangle is a sliver
  /// Of the triangles that may become slivers nevertheless, where they follow what bends one way.
  /// 0: a collapse makes none but in the place of as many. Clusters do, in the first phase; later
  /// ones take those away.
  float sliverShare = 0.08f;
  /// The same where the surface bends both ways, at tolerances of up to two voxels.
  float bentSliverShare = 0.015f;
  bool clusters = true;  ///< whether clusters are contracted first
  /// Triangles of a result to a tolerance that may not be, say as they intersect once they are
  /// written in another precision. Around them less is reduced. Empty: none.
  std::function<std::vector<Index>(const ReducedMesh&)> faults;
  int attempts = 6;  ///< most to reduce less where the certificate or `faults` ask for it
  /// For tests: a guard that is not asked, so that what it guards against is seen to happen.
  Outcome switchedOff = Outcome::Done;
};

/// Options to keep an angle of so many degrees, or the defaults for 0.
[[nodiscard]] Options optionsForAngle(double degrees);

/// Reduces a triangle mesh to a distance from a reference, or to a number of triangles, in one pass
/// of local operations, each of them guarded: what is made stays.
///
///     Reduction reduction(input, reference, standsFor, scales, options, job);
///     reduction.toTolerance(0.1f);  // again with a larger one: the next level of a chain
///     const Certificate certificate = reduction.certificate();
///     const ReducedMesh mesh = reduction.mesh();
///
/// Promised for an oriented manifold without folds, closed or with open borders: the same topology,
/// open borders as they were, no new intersection, no new fold, every point of either surface
/// within Certificate::largest of the other, and the same bytes for any number of threads. The
/// certificate is measured. Where it is beyond the tolerance, which folds of the reference can
/// bring about, the mesh is reduced again from what it was, and less there.
///
/// Cost: 2 (smooth) to 6 microseconds (thin shells) a vertex of the input on one thread.
class Reduction {
 public:
  /// `standsFor`: for each reference vertex the input vertex that stands for it; empty if the input
  /// is the reference. `scales`: for each reference vertex what the tolerance is multiplied with
  /// there, 0: nothing may change; empty: 1 everywhere. `job` must outlive this.
  Reduction(const InputMesh& input, const InputMesh& reference, std::span<const Index> standsFor,
            std::vector<float> scales, Options options, base::Job& job);
  ~Reduction();
  Reduction(const Reduction&) = delete;
  Reduction& operator=(const Reduction&) = delete;

  /// Divides the input into regions, whose lines are kept from then on. To be called first. They
  /// are asked for again where the input is.
  void setRegions(std::function<Regions()> regions);

  /// For tolerances to come, in place of `scales` of the constructor: the surface must be within
  /// them. Not where there were none when a second tolerance was reached, as another reference may
  /// stand in then.
  void setScales(std::vector<float> scales);

  /// Replaces parts of the input, and then has all triangles of some regions stay where they are.
  /// `isHeld`: for each region. To be called after setRegions().
  void replaceParts(std::span<const ReplacedPart> parts, const std::vector<std::uint8_t>& isHeld);

  /// As few triangles as can be found within `tolerance` voxels of the reference. Below
  /// kLeastTolerance nothing is done but to measure a mesh that is not the reference.
  void toTolerance(float tolerance, LineMode lines = LineMode::Free);

  /// At most `count` triangles and few less, within the least tolerance found that reaches it, up
  /// to `mostTolerance` voxels. Returns that tolerance. Where the count is out of reach, the mesh
  /// has more triangles and mostTolerance is returned. Where the certificate is beyond the
  /// tolerance, that place is left as it was, and the search begins again. Takes three to five
  /// times as long as a tolerance that gives as many, ten on small thin shells, each time, and the
  /// memory of four meshes more.
  float toCount(Index count, float mostTolerance);

  [[nodiscard]] Index triangleCount() const {
    return static_cast<Index>(surface_.triangles.size());
  }
  /// What was measured last. A mesh that is still the reference has a certificate of 0. From a
  /// tolerance of many times the first certificate on distances are bounded by way of the mesh that
  /// has it, and `worst` and `beyond` are faces of that mesh.
  [[nodiscard]] Certificate certificate() const;
  /// How often the mesh was reduced to the last tolerance.
  [[nodiscard]] int attempts() const { return attempt_ + 1; }
  [[nodiscard]] ReducedMesh mesh() const;
  /// For each vertex, by its number when the last step of LineMode::Alone began, where it has gone
  /// in that step, at once: a vertex that may have gone on in turn. Itself if it has not. Empty
  /// before there is such a step.
  [[nodiscard]] const std::vector<Index>& wentInto() const { return surface_.into; }
  /// For those that have gone the plane of the line that they were on, or beside.
  [[nodiscard]] const std::vector<Index>& wentFor() const { return surface_.intoPlane; }
  /// The state between two steps.
  [[nodiscard]] const Surface& surface() const { return surface_; }
  /// The same, without a copy. To be called last.
  [[nodiscard]] Surface takeSurface() { return std::move(surface_); }
  /// What was tried and made since the beginning.
  [[nodiscard]] const OperationCounts& counts() const { return counts_; }

 private:
  static constexpr int kPhases = 16;     ///< most at one tolerance
  static constexpr int kRampPhases = 2;  ///< at one on the way to a larger one
  /// The first tolerance on the way to larger ones, in voxels, and the factor by which they grow.
  static constexpr float kFirstStep = 0.1f;
  static constexpr float kStep = 4;
  /// None is followed by one below this many times itself.
  static constexpr float kRampStep = 1.5f;
  /// Voxels. Where a larger tolerance gave little, the shape of triangles is in the way: slivers,
  /// fans and turns are allowed from then on.
  static constexpr float kStuckTolerance = 2;
  // Attempts after which new folds are held: one that is left then cannot be helped.
  static constexpr int kFoldAttempts = 2;

  struct Meshes {
    Surface surface;
    ReferenceMesh reference;
    float largestScale;
  };
  struct State {
    Surface surface;
    float tolerance;
    int phaseNumber;
    bool isReference;
  };

  Reduction(Meshes meshes, bool isReference, Options options, base::Job& job);
  static Meshes meshesOf(const InputMesh& input, const InputMesh& reference,
                         std::span<const Index> standsFor, std::vector<float> scales,
                         base::Job& job);
  [[nodiscard]] State state() const;
  void restore(const State& state);
  [[nodiscard]] Surface wholeSurface() const;
  void descendTo(float tolerance, Index count);
  float toCountWithin(Index count, float mostTolerance);
  void chooseReference(float tolerance);
  /// How far a distance to the present reference may be from that to the one that came in.
  [[nodiscard]] float proxyError() const { return original_ ? proxy_->largest : 0; }
  bool findCount(Index count, float mostTolerance);
  void buildParts(const PartSize& size);
  void beginLines();
  void measureWithin(float expected);
  void addFacesNear(const std::vector<Index>& triangles, std::vector<Index>& faces) const;
  [[nodiscard]] std::vector<Index> newFolds() const;
  void hold(const std::vector<Index>& faces, float tolerance);
  void reduce(float tolerance, Index count, int phases);
  /// Less than a sixteenth of what there was: further phases or tolerances hardly pay.
  [[nodiscard]] bool hasRemovedLittle(Index before) const {
    return triangleCount() > before - before / 16;
  }
  void runPhase(const PhaseLimits& limits, Index count);
  [[nodiscard]] std::vector<Index> quotas(Index count) const;
  [[nodiscard]] std::vector<Index> largestFirst() const;
  std::unique_ptr<Part> takePart();
  void returnPart(std::unique_ptr<Part> part);

  Options options_;
  base::Job& job_;
  std::function<Regions()> regions_;  ///< empty without regions
  Surface surface_;
  ReferenceMesh reference_;
  std::optional<Proxy> proxy_;  ///< the mesh of the first tolerance, once there is a second
  std::optional<ReferenceMesh> original_;  ///< that came in, once the proxy is the reference
  Partition partition_;
  std::mutex partsMutex_;
  std::vector<std::unique_ptr<Part>> parts_;  ///< as many as threads have been at work
  OperationCounts counts_, lastCounts_;
  std::vector<std::array<Index, 2>> lastChanges_;  ///< see Part::changes()
  std::vector<Index> lastWithWays_;                ///< see Part::withWays()
  std::vector<Form> lastForms_;                    ///< see Part::forms()
  std::vector<SurfaceChanges> lastStored_;         ///< see Part::stored()
  Certificate certificate_;                        ///< of the distance to the present reference
  float largestScale_;  ///< what tolerances from outside are multiplied with
  bool isReference_;    ///< the mesh is the reference still
  std::vector<std::vector<PartTree::Node>> trees_;  ///< of the phases at the present tolerance
  std::size_t nextTree_ = 0;
  int attempt_ = 0;  ///< at the present tolerance, from 0 on
  LineMode lines_ = LineMode::Free;
  bool keepsShape_ = true;  ///< of triangles; false near the least number of them
  int phaseNumber_ = 0;
  float tolerance_ = 0;
};

}  // namespace tufa::reduce
