#include "reduce/replace_parts.h"

#include <utility>

#include "base/huge_pages.h"
#include "base/ranked_bits.h"

namespace tufa::reduce {
namespace {

class Replacer {
 public:
  Replacer(Surface& surface, const ReferenceMesh& reference, base::Job& job)
      : s_(surface), reference_(reference), job_(job), left_(surface.position.size()) {}

  void run(std::span<const ReplacedPart> parts) {
    isReplaced_.assign(s_.triangles.size(), 0);
    for (const ReplacedPart& part : parts) {
      for (const Index f : part.faces) isReplaced_[f] = 1;
    }
    keepRest();
    for (const ReplacedPart& part : parts) add(part);
    finish();
  }

 private:
  void keepRest() {
    now_.assign(s_.triangles.size(), kNone);
    for (Index t = 0; t < now_.size(); ++t) {
      job_.pollCancelled(t);
      if (isReplaced_[t] != 0) continue;
      for (const Index v : s_.triangles[t].vertices) left_.add(v);
    }
    left_.count();
    left_.forAll([&](std::size_t at) {
      const auto v = static_cast<Index>(at);
      addVertex(s_.position[v], s_.flags[v], v, faceOf(s_, reference_, v), s_.lineKind[v]);
    });
    for (Index t = 0; t < now_.size(); ++t) {
      job_.pollCancelled(t);
      if (isReplaced_[t] != 0) continue;
      const auto v = s_.triangles[t].vertices;
      now_[t] = static_cast<Index>(triangles_.size());
      triangles_.emplace_back(left_.rank(v[0]), left_.rank(v[1]), left_.rank(v[2]));
      region_.push_back(s_.region[t]);
    }
    base::resizeLarge(owner_, s_.owner.size(), job_);
    for (std::size_t r = 0; r < owner_.size(); ++r) {
      owner_[r] = s_.owner[r] == kNone ? kNone : now_[s_.owner[r]];
    }
  }

  void addVertex(Vec3f position, std::uint8_t flags, Index source, Index face, LineKind kind) {
    position_.push_back(position), flags_.push_back(flags);
    source_.push_back(source), face_.push_back(face);
    lineKind_.push_back(kind);
  }

  // Vertices at the part's border have not moved.
  void add(const ReplacedPart& part) {
    const Surface& p = part.surface;
    std::vector<Index> numbers(p.position.size());
    for (Index v = 0; v < numbers.size(); ++v) {
      const Index own = p.sourceOf(v), source = own == kNone ? kNone : part.vertices[own];
      if (source != kNone && left_.has(source)) {
        numbers[v] = left_.rank(source);
        continue;
      }
      numbers[v] = static_cast<Index>(position_.size());
      const Index face = p.face[v];
      addVertex(part.positions[v], p.flags[v], source, face == kNone ? kNone : part.faces[face],
                p.lineKind[v]);
    }
    const auto first = static_cast<Index>(triangles_.size());
    for (std::size_t t = 0; t < p.triangles.size(); ++t) {
      const auto v = p.triangles[t].vertices;
      triangles_.emplace_back(numbers[v[0]], numbers[v[1]], numbers[v[2]]);
      region_.push_back(p.region[t]);
    }
    for (std::size_t r = 0; r < p.owner.size(); ++r) {
      Index& owner = owner_[part.vertices[r]];
      if (owner == kNone && p.owner[r] != kNone) owner = first + p.owner[r];
    }
  }

  // Flags tell of the mesh as it came in; axes, of the stars that are there now.
  void finish() {
    Surface made = makeSurface(std::move(position_), std::move(triangles_), job_);
    s_.position = std::move(made.position);
    s_.triangles = std::move(made.triangles);
    s_.axis = std::move(made.axis);
    s_.flags = std::move(made.flags);
    for (std::size_t v = 0; v < s_.flags.size(); ++v) {
      s_.flags[v] = static_cast<std::uint8_t>(s_.flags[v] | (flags_[v] & ~kBorder));
    }
    s_.source = std::move(source_), s_.face = std::move(face_);
    s_.owner = std::move(owner_);
    s_.region = std::move(region_);
    s_.lineKind = std::move(lineKind_);
    s_.isWhole = false;
  }

  Surface& s_;
  const ReferenceMesh& reference_;
  base::Job& job_;
  base::RankedBits left_;  ///< the vertices of triangles that are not replaced
  std::vector<std::uint8_t> isReplaced_;
  std::vector<Index> now_;  ///< numbers of the triangles that are not
  std::vector<Vec3f> position_;
  std::vector<std::uint8_t> flags_;
  std::vector<Index> source_, face_, owner_, region_;
  std::vector<LineKind> lineKind_;
  std::vector<Triangle> triangles_;
};

}  // namespace

void replaceParts(Surface& surface, const ReferenceMesh& reference,
                  std::span<const ReplacedPart> parts, base::Job& job) {
  Replacer(surface, reference, job).run(parts);
}

void holdRegions(Surface& s, const std::vector<std::uint8_t>& isHeld, base::Job& job) {
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    job.pollCancelled(t);
    if (isHeld[s.region[t]] == 0) continue;
    for (const Index v : s.triangles[t].vertices) s.flags[v] |= kBorder;
  }
}

}  // namespace tufa::reduce
