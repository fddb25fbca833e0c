#include "refine/collapse/collapse.h"

#include <algorithm>
#include <limits>

#include "refine/collapse/collapser.h"
#include "refine/collapse/flip_slivers.h"

namespace tufa::refine {
namespace {

// Edges are collapsed with this share of the error budget first, so that dear collapses do not come
// before cheap ones beside them; then with so many times more, up to all of it. Meshes of few
// triangles go in smaller steps.
constexpr double kFirstBudget = 0.4, kMoreBudget = 2.5;
constexpr std::size_t kFewTriangles = 30000;
constexpr double kFirstBudgetOfFew = 0.3, kMoreBudgetOfFew = 1.5;
// For a number of triangles, the budget scale grows by this factor at a time, by the larger one
// where that removed less than kLittle of the triangles, up to kWidestBudget.
constexpr double kWiderBudget = 1.25;
constexpr double kMuchWiderBudget = 2;
constexpr double kLittle = 0.01;
constexpr double kWidestBudget = 1e9;

// Vertices of a part at most: the data of a part should fit a core's cache.
constexpr std::size_t kRegion = 4096;
constexpr std::size_t kGrain = 4096;

class Collapse {
 public:
  Collapse(const Mesh& mesh, const std::vector<base::Quadric>& planes, const Bounds& bounds,
           base::Job& job)
      : state_(mesh, planes, bounds), job_(job) {}

  // Rounds with growing budget scale, after a repeat of earlier steps if there are any. For a
  // number of triangles the scale may exceed 1, otherwise it ends there.
  void run() {
    const Bounds& bounds = state_.bounds;
    const bool few = state_.mesh.triangleCount() < kFewTriangles;
    if (bounds.before != nullptr) {
      repeat(*bounds.before);
    } else {
      attachFrom(0);
    }
    if (bounds.onlyRepeat) return;
    if (bounds.before == nullptr && bounds.triangles == 0)
      state_.budgetScale = few ? kFirstBudgetOfFew : kFirstBudget;
    for (bool anew = bounds.before == nullptr;; anew = true) {
      const std::size_t start = state_.mesh.triangleCount();
      // After a repeat, only where something differs from the result before.
      const bool tooFar =
          collapseAt(anew ? std::vector<std::uint8_t>() : state_.mesh.dilated(state_.changed));
      const std::size_t left = state_.mesh.triangleCount();
      if (bounds.triangles == 0) {
        if (state_.budgetScale >= 1) return;
        state_.budgetScale =
            std::min(1.0, state_.budgetScale * (few ? kMoreBudgetOfFew : kMoreBudget));
        continue;
      }
      if (left <= bounds.triangles) return;
      if (anew && !tooFar) return;  // a larger budget would not help
      const bool little = static_cast<double>(start - left) < kLittle * static_cast<double>(start);
      state_.budgetScale *= anew && little ? kMuchWiderBudget : kWiderBudget;
      if (state_.budgetScale > kWidestBudget) return;
    }
  }

  [[nodiscard]] Collapsed result() {
    Collapsed out;
    out.budgetScale = state_.budgetScale;
    const std::vector<std::uint8_t> turned = turnThin();
    out.sampleTriangles = state_.samples.triangles();
    out.steps = std::move(steps_);
    out.phases = std::move(phases_);
    const auto vertices = static_cast<std::uint32_t>(state_.mesh.vertexCount());
    std::vector<VertexIndex> numbers(vertices, kNone);
    for (std::uint32_t i = 0; i < vertices; ++i) {
      if (!state_.mesh.isRoot(i)) continue;
      numbers[i] = static_cast<VertexIndex>(out.mesh.positions.size());
      const Vec3& p = state_.mesh.point(i);
      out.mesh.positions.emplace_back(p[0], p[1], p[2]);
      out.mesh.normals.push_back(normalOf(i));
    }
    out.members.resize(out.mesh.positions.size());
    out.vertexOf.resize(vertices);
    for (std::uint32_t i = 0; i < vertices; ++i) {
      out.vertexOf[i] = numbers[state_.mesh.rootOf(i)];
      ++out.members[out.vertexOf[i]];
    }
    const auto corner = [&](std::size_t i) { return numbers[state_.mesh.corner(i)]; };
    std::vector<std::uint32_t> sources;
    const auto addTriangle = [&](std::size_t t, std::uint32_t polygon) {
      out.mesh.triangles.emplace_back(corner(t), corner(t + 1), corner(t + 2));
      sources.push_back(polygon);
      if (turned[t / 3] == 0) return;
      const auto& v = out.mesh.triangles.back().vertices;
      out.turned.insert(out.turned.end(), v.begin(), v.end());
    };
    for (std::uint32_t polygon = 0; polygon < state_.given.quads.size(); ++polygon) {
      const std::size_t t = std::size_t{6} * polygon;
      const bool first = state_.mesh.isAlive(t), second = state_.mesh.isAlive(t + 3);
      if (first && second && turned[t / 3] == 0 && turned[t / 3 + 1] == 0 && !isOfFour(t)) {
        out.mesh.quads.emplace_back(corner(t), corner(t + 1), corner(t + 2), corner(t + 5));
        out.sources.push_back(polygon);
        continue;
      }
      if (first) addTriangle(t, polygon);
      if (second) addTriangle(t + 3, polygon);
    }
    for (std::size_t i = 0; i < state_.given.triangles.size(); ++i) {
      const std::size_t t = 6 * state_.given.quads.size() + 3 * i;
      if (state_.mesh.isAlive(t)) {
        addTriangle(t, static_cast<std::uint32_t>(state_.given.quads.size() + i));
      }
    }
    out.sources.insert(out.sources.end(), sources.begin(), sources.end());
    return out;
  }

 private:
  // Flips edges of the result, and marks triangles that were flipped. What is kept for a next
  // collapse is of the mesh before the flips.
  std::vector<std::uint8_t> turnThin() {
    if (state_.bounds.turning.empty())
      return std::vector<std::uint8_t>(state_.mesh.cornerCount() / 3, 0);
    std::vector<double> budget(state_.mesh.vertexCount(), std::numeric_limits<double>::infinity());
    for (std::uint32_t i = 0; i < budget.size(); ++i) {
      double& own = budget[state_.mesh.rootOf(i)];
      own = std::min(own, state_.budgetScale * static_cast<double>(state_.bounds.turning[i]));
      if (state_.mesh.isRoot(i) && state_.mesh.isOnBoundary(i)) own = 0;
    }
    return flipSlivers(state_.mesh, state_.bounds, budget, state_.samples);
  }

  // Whether the quad of two triangles is half of a closed surface of four triangles. As quads, both
  // halves would have the same corners.
  [[nodiscard]] bool isOfFour(std::size_t t) const {
    return state_.mesh.degree(state_.mesh.corner(t)) == 3 &&
           state_.mesh.degree(state_.mesh.corner(t + 1)) == 3 &&
           state_.mesh.degree(state_.mesh.corner(t + 2)) == 3;
  }

  [[nodiscard]] Normal normalOf(VertexIndex vertex) const {
    Vec3 sum = state_.planes[vertex].normals;
    if (state_.joined[vertex] == 0 || !sum.normalize()) return state_.given.normals[vertex];
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
  }

  // Repeats the collapses of an earlier result, phase by phase. Around those that are not repeated,
  // edges may then be collapsed in another way.
  void repeat(const Collapsed& before) {
    state_.budgetScale = before.budgetScale;
    const std::size_t known = before.sampleTriangles.size();
    attachFrom(known);
    // Steps of one group were inside one part then, and are now.
    const Regions whole = oneRegion(state_.mesh);
    const std::span<const Step> steps(before.steps);
    const std::span<const std::uint8_t> rolledBack(state_.bounds.rolledBack);
    std::size_t first = 0;
    for (const std::vector<std::size_t>& phase : before.phases) {
      std::vector<Collapser> collapsers(phase.size(), Collapser(state_, whole));
      job_.forRanges(phase.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t from = i == 0 ? first : phase[i - 1], count = phase[i] - from;
          collapsers[i].repeat(steps.subspan(from, count),
                               rolledBack.empty() ? rolledBack : rolledBack.subspan(from, count),
                               job_);
        }
      });
      first = phase.back();
      keepSteps(collapsers);
    }
    std::vector<std::uint32_t> places(known);
    job_.forRanges(known, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t t = before.sampleTriangles[i];
        const auto isSame = [&](std::size_t corner) {
          return state_.changed[state_.mesh.corner(corner)] == 0;
        };
        const bool same = state_.mesh.isAlive(t) && isSame(t) && isSame(t + 1) && isSame(t + 2);
        places[i] = same ? t : locate(i);
      }
    });
    attach(0, places);
  }

  // Attaches the samples from `first` on to the triangles nearest to them.
  void attachFrom(std::size_t first) {
    std::vector<std::uint32_t> places(state_.bounds.samples.size() - first);
    job_.forRanges(places.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) places[i] = locate(first + i);
    });
    attach(first, places);
  }
  [[nodiscard]] std::uint32_t locate(std::size_t sample) const {
    return locateSample(state_.mesh, state_.given, state_.bounds.samples[sample]);
  }
  void attach(std::size_t first, const std::vector<std::uint32_t>& places) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      job_.pollCancelled(i);
      state_.samples.attach(static_cast<std::uint32_t>(first + i), places[i]);
    }
  }

  // Collapses edges at the marked vertices, at all without marks: first those inside the parts of
  // one partition, then those left that are inside the parts of another, and last the rest. Whether
  // one was refused for want of budget.
  bool collapseAt(const std::vector<std::uint8_t>& marks) {
    const auto isMarked = [&](VertexIndex vertex) { return marks.empty() || marks[vertex] != 0; };
    const std::size_t count =
        marks.empty() ? state_.mesh.vertexCount()
                      : static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1));
    const bool whole = state_.bounds.triangles > 0 || !state_.rim.empty() || count <= kRegion;
    const Regions regions =
        whole ? oneRegion(state_.mesh) : makeRegions(state_.mesh, kRegion, Parting::Halves, job_);
    std::vector<EdgeEnds> left;
    bool tooFar = collapsePhase(
        regions,
        [&](Collapser& collapser, std::size_t region) {
          const std::vector<VertexIndex>& own = regions.vertices[region];
          for (std::size_t i = 0; i < own.size(); ++i) {
            job_.pollCancelled(i);
            if (isMarked(own[i])) collapser.proposeAround(own[i], marks.empty());
          }
        },
        left);
    if (regions.vertices.size() == 1) return tooFar;
    tooFar |= collapseEdges(makeRegions(state_.mesh, kRegion, Parting::Thirds, job_), left);
    tooFar |= collapseEdges(oneRegion(state_.mesh), left);
    return tooFar;
  }

  // Collapses what was postponed; `edges` receives what is postponed again.
  bool collapseEdges(const Regions& regions, std::vector<EdgeEnds>& edges) {
    const EdgeMesh& mesh = state_.mesh;
    std::sort(edges.begin(), edges.end(), [&](const EdgeEnds& one, const EdgeEnds& other) {
      return one.first != other.first ? mesh.isBefore(one.first, other.first)
                                      : mesh.isBefore(one.second, other.second);
    });
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    // Where an end was joined to another vertex, that one's edges were postponed too.
    std::erase_if(edges, [&](const EdgeEnds& edge) {
      return !mesh.isRoot(edge.first) || !mesh.isRoot(edge.second);
    });
    std::vector<std::vector<EdgeEnds>> own(regions.vertices.size());
    for (const EdgeEnds& edge : edges) own[regions.of[edge.first]].push_back(edge);
    edges.clear();
    return collapsePhase(
        regions,
        [&](Collapser& collapser, std::size_t region) {
          for (const auto& [a, b] : own[region]) collapser.propose(a, b);
        },
        edges);
  }

  // Collapses edges in all parts in parallel; propose(collapser, part) tells which. `postponed`
  // receives edges that are inside no part.
  template <class Propose>
  bool collapsePhase(const Regions& regions, const Propose& propose,
                     std::vector<EdgeEnds>& postponed) {
    // Each collapse removes two triangles.
    const std::size_t wanted = state_.bounds.triangles, count = state_.mesh.triangleCount();
    const std::size_t most = count > wanted ? (count - wanted + 1) / 2 : 0;
    std::vector<Collapser> collapsers(regions.vertices.size(), Collapser(state_, regions));
    job_.forRanges(collapsers.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        propose(collapsers[i], i);
        collapsers[i].run(most, job_);
      }
    });
    bool tooFar = false;
    for (const Collapser& collapser : collapsers) {
      tooFar |= collapser.tooFar();
      postponed.insert(postponed.end(), collapser.postponed().begin(), collapser.postponed().end());
    }
    keepSteps(collapsers);
    return tooFar;
  }

  void keepSteps(const std::vector<Collapser>& collapsers) {
    const std::size_t before = steps_.size();
    std::vector<std::size_t> ends;
    for (const Collapser& collapser : collapsers) {
      steps_.insert(steps_.end(), collapser.steps().begin(), collapser.steps().end());
      ends.push_back(steps_.size());
    }
    state_.mesh.countCollapses(steps_.size() - before);
    if (steps_.size() > before) phases_.push_back(std::move(ends));
  }

  CollapseState state_;
  base::Job& job_;
  std::vector<Step> steps_;
  std::vector<std::vector<std::size_t>> phases_;
};

}  // namespace

Collapsed collapse(const Mesh& mesh, const std::vector<base::Quadric>& planes, const Bounds& bounds,
                   base::Job& job) {
  Collapse collapse(mesh, planes, bounds, job);
  collapse.run();
  return collapse.result();
}

}  // namespace tufa::refine
