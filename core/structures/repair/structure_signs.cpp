#include "core/structures/repair/structure_signs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "core/base/numbers/index.h"
#include "core/base/numbers/statistics.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/template_making/voxel_components.h"

namespace homolog {

namespace {

/// Distances that count as far, as shares of an organ's size (the cube root of its volume).
constexpr double far_from_expected = 0.1, deep_in_fit = 0.05, far_from_fit = 0.1, cut_off_near = 0.25;

double volume_mm3(const Mesh& mesh) {
  return 1000 * std::abs(enclosed_volume_ml(mesh));
}

/// The work on one structure.
class Signs {
 public:
  Signs(const SetInMap& subject, const std::vector<std::optional<Mesh>>& expected, std::size_t of, const Mesh& fit,
        const VolumeRead& map, int frame)
      : subject_(subject),
        expected_(expected),
        of_(of),
        value_(subject.structures[of].segment.value),
        map_(layer_of(map, subject.structures[of].segment.layer, frame).first->geometry),
        empty_beyond_(layer_of(map, subject.structures[of].segment.layer, frame).first->empty_beyond_slices),
        there_(around_structure(subject, map, frame, of, reach(fit), margin(fit, map_))),
        own_(voxels_with(there_.labels, value_), there_.grid),
        fit_(voxelise(fit, there_.grid), there_.grid),
        size_mm_(std::cbrt(static_cast<double>(own_.voxels) * there_.grid.voxel_volume_mm3())) {
    if (own_.voxels > 0 && expected_[of_]) here_.emplace(voxelise(*expected_[of_], there_.grid), there_.grid);
  }

  StructureSigns find() {
    if (own_.voxels == 0) return {};
    find_islands();
    find_holes_and_bridges();
    if (expected_[of_]) compare_with_expected();
    return std::move(signs_);
  }

 private:
  Box reach(const Mesh& fit) const {
    Box box = bounds_of(fit.points);
    if (expected_[of_]) box.extend(bounds_of(expected_[of_]->points));
    const Volume& mask = *subject_.structures[of_].mask;
    box.extend(mask.geometry.bounds_mm());
    return box;
  }
  static int margin(const Mesh& fit, const VolumeGeometry& grid) {
    const double most_mm = 0.2 * std::cbrt(volume_mm3(fit));
    return 1 + static_cast<int>(std::ceil(most_mm / grid.spacing_mm.maxCoeff()));
  }
  double share(std::size_t voxels) const { return static_cast<double>(voxels) / static_cast<double>(own_.voxels); }
  double coarse_mm() const { return there_.grid.spacing_mm.maxCoeff(); }
  void change(std::size_t v, int value, std::vector<VoxelChange>& changes) const {
    changes.push_back({there_.voxel_of_map(v, map_), there_.labels[v], value});
  }

  void find_islands() {
    const auto parts = connected_components(own_.inside, there_.grid.dims, Touching::faces_and_edges);
    const auto main = static_cast<std::int32_t>(std::ranges::max_element(parts.sizes) - parts.sizes.begin());
    main_ = std::vector<std::uint8_t>(own_.inside.size(), 0);
    const std::size_t row = index(there_.grid.dims[0]), plane = row * index(there_.grid.dims[1]);
    const std::vector<int> around = labels_around(parts);
    std::set<std::int32_t> specks;
    for (std::size_t v = 0; v < main_.size(); ++v) {
      if (parts.part[v] < 0) continue;
      const std::array<int, 3> here{static_cast<int>(v % row), static_cast<int>(v % plane / row),
                                    static_cast<int>(v / plane)};
      bool at_border = false;
      for (std::size_t a = 0; a < 3; ++a) {
        if (a == 2 && empty_beyond_) continue;
        const int in_map = here[a] + there_.box.first[a];
        at_border = at_border || in_map == 0 || in_map == map_.dims[a] - 1;
      }
      // What lies there far from its fit is an island, and does not say that the structure goes on.
      const bool is_its = parts.part[v] == main || fit_.inside[v] != 0 || fit_.to[v] <= cut_off_near * size_mm_;
      signs_.at_border += at_border && is_its ? share(1) : 0;
      if (parts.part[v] == main) {
        main_[v] = 1;
        continue;
      }
      // A part that the fit holds is one of its own, which a gap of a voxel parts from it.
      if (fit_.inside[v] != 0) continue;
      signs_.islands += share(1);
      specks.insert(parts.part[v]);
      change(v, around[parts.part[v]], signs_.without_islands);
    }
    signs_.specks = specks.size();
  }

  template <class Is>
  std::vector<std::uint8_t> voxels_where(const Is& is) const {
    std::vector<std::uint8_t> set(main_.size());
    for (std::size_t v = 0; v < set.size(); ++v) set[v] = is(v) ? 1 : 0;
    return set;
  }

  /// Calls `visit` with each voxel that shares a face with one; gives whether it lies at the border of the box.
  template <class Visit>
  bool for_each_beside(std::size_t v, const Visit& visit) const {
    const auto& dims = there_.grid.dims;
    const std::size_t row = index(dims[0]), plane = row * index(dims[1]);
    const std::array<std::size_t, 3> here{v % row, v % plane / row, v / plane}, step{1, row, plane};
    bool at_border = false;
    for (std::size_t a = 0; a < 3; ++a) {
      if (here[a] > 0)
        visit(v - step[a]);
      else
        at_border = true;
      if (here[a] + 1 < index(dims[a]))
        visit(v + step[a]);
      else
        at_border = true;
    }
    return at_border;
  }

  /// The label that each part lies in; 0 where it has none around it, or several.
  std::vector<int> labels_around(const VoxelComponents& parts) const {
    constexpr double nearly_all = 0.8;
    std::vector<std::map<int, std::size_t>> beside(parts.sizes.size());
    for (std::size_t v = 0; v < parts.part.size(); ++v)
      if (parts.part[v] >= 0)
        for_each_beside(v, [&](std::size_t other) {
          if (parts.part[other] != parts.part[v]) ++beside[parts.part[v]][there_.labels[other]];
        });
    std::vector<int> around(beside.size());
    for (std::size_t part = 0; part < beside.size(); ++part) {
      std::size_t all = 0;
      for (const auto& [label, count] : beside[part]) all += count;
      for (const auto& [label, count] : beside[part])
        if (label > 0 && static_cast<double>(count) >= nearly_all * static_cast<double>(all)) around[part] = label;
    }
    return around;
  }

  /// Whether each part of a hole goes through the structure: its two largest mouths, which are the empty voxels beside
  /// it as far as they hang together, are about as wide and lie at opposite ends.
  std::vector<char> go_through(const VoxelComponents& parts) const {
    constexpr double as_wide = 0.25;
    std::vector<std::uint8_t> beside(parts.part.size());
    for (std::size_t v = 0; v < beside.size(); ++v)
      if (parts.part[v] >= 0)
        for_each_beside(v, [&](std::size_t other) {
          if (parts.part[other] < 0 && there_.labels[other] == 0) beside[other] = 1;
        });
    const auto mouths = connected_components(beside, there_.grid.dims, Touching::faces_and_edges);
    std::vector<std::map<std::int32_t, std::set<std::size_t>>> of_part(parts.sizes.size());
    std::vector<Vec3> middles(parts.sizes.size(), Vec3::Zero());
    for (std::size_t v = 0; v < beside.size(); ++v) {
      if (parts.part[v] < 0) continue;
      const std::size_t part = index(parts.part[v]);
      middles[part] += place_of_voxel(there_.grid, v) / static_cast<double>(parts.sizes[part]);
      for_each_beside(v, [&](std::size_t other) {
        if (mouths.part[other] >= 0) of_part[part][mouths.part[other]].insert(other);
      });
    }
    std::vector<char> through(parts.sizes.size());
    for (std::size_t part = 0; part < through.size(); ++part) {
      std::vector<std::set<std::size_t>> all;
      for (auto& [mouth, voxels] : of_part[part]) all.push_back(std::move(voxels));
      if (all.size() < 2) continue;
      std::ranges::stable_sort(all, std::ranges::greater{}, &std::set<std::size_t>::size);
      const auto towards = [&](const std::set<std::size_t>& mouth) {
        Vec3 sum = Vec3::Zero();
        for (const std::size_t v : mouth) sum += place_of_voxel(there_.grid, v) - middles[part];
        return sum;
      };
      through[part] = static_cast<double>(all[1].size()) >= as_wide * static_cast<double>(all[0].size()) &&
                      towards(all[0]).dot(towards(all[1])) < 0;
    }
    return through;
  }

  /// Keeps holes that the label encloses, and beside neighbours those that go through it. One that is open to one side
  /// alone may be the organ's own form that the fit bridges, as the sinus of a kidney is; an enclosed one that is
  /// narrow everywhere is a vessel or a calyx.
  void leave_cavities(std::vector<std::uint8_t>& hole) const {
    constexpr double narrow = 0.06;  // half as wide, as a share of the size: those of expert masks are below
    const Body empty(voxels_where([&](std::size_t v) { return there_.labels[v] == 0; }), there_.grid);
    const auto rooms = connected_components(empty.inside, there_.grid.dims, Touching::faces);
    std::vector<char> is_outside(rooms.sizes.size()), is_wide(rooms.sizes.size());
    for (std::size_t v = 0; v < hole.size(); ++v) {
      if (rooms.part[v] < 0) continue;
      if (for_each_beside(v, [](std::size_t) {})) is_outside[rooms.part[v]] = 1;
      if (empty.depth[v] >= narrow * size_mm_) is_wide[rooms.part[v]] = 1;
    }
    const auto parts = connected_components(hole, there_.grid.dims, Touching::faces);
    const auto through = go_through(parts);
    for (std::size_t v = 0; v < hole.size(); ++v) {
      if (hole[v] == 0) continue;
      const std::size_t room = index(rooms.part[v]);
      if (is_outside[room] == 0 && is_wide[room] == 0) hole[v] = 0;
      if (is_outside[room] == 0) continue;
      if (!expected_[of_] || through[parts.part[v]] == 0) hole[v] = 0;
    }
  }

  void find_holes_and_bridges() {
    const double deep_mm = std::max(deep_in_fit * size_mm_, coarse_mm());
    const double far_mm = std::max(far_from_fit * size_mm_, coarse_mm());
    auto hole = voxels_where(
        [&](std::size_t v) { return there_.labels[v] == 0 && fit_.inside[v] != 0 && fit_.depth[v] > deep_mm; });
    auto bridge =
        voxels_where([&](std::size_t v) { return main_[v] != 0 && fit_.inside[v] == 0 && fit_.to[v] > far_mm; });
    leave_cavities(hole);
    signs_.holes = share_of_large(hole);
    signs_.bridges = share_of_large(bridge);
    std::vector<std::uint8_t> filled(main_.size());  // where a hole may be filled beyond the fit
    std::vector<std::uint8_t> bar(main_.size()), line(main_.size());
    if (expected_[of_]) find_tunnels_and_bars(hole, bar, line, filled);
    for (std::size_t v = 0; v < main_.size(); ++v) bridge[v] |= bar[v];
    // The rest of each hole reaches up to the surface, and that of each bridge back to it.
    if (const Body core(std::move(hole), there_.grid); core.voxels > 0)
      for (std::size_t v = 0; v < main_.size(); ++v)
        if (there_.labels[v] == 0 && (fit_.inside[v] != 0 || filled[v] != 0) && core.to[v] <= 1.5 * deep_mm)
          change(v, value_, signs_.without_holes);
    for (const auto& [cores, changes] :
         {std::pair{&bridge, &signs_.without_bridges}, std::pair{&bar, &signs_.without_bars}})
      if (const Body core(std::move(*cores), there_.grid); core.voxels > 0)
        for (std::size_t v = 0; v < main_.size(); ++v)
          if (own_.inside[v] != 0 && fit_.inside[v] == 0 && core.to[v] <= 1.5 * far_mm) change(v, 0, *changes);
    // A thin line is taken away alone: what lies about its root is the organ's.
    if (const Body core(std::move(line), there_.grid); core.voxels > 0)
      for (std::size_t v = 0; v < main_.size(); ++v)
        if (own_.inside[v] != 0 && fit_.inside[v] == 0 && here_->inside[v] == 0 && core.to[v] <= 1.5 * coarse_mm())
          change(v, 0, signs_.without_bars);
  }

  /// Leaves the large parts alone. Gives what share of the structure they are.
  double share_of_large(std::vector<std::uint8_t>& set) const {
    constexpr double least_share = 0.0005;
    set = large_parts(std::move(set), there_.grid, std::max(2.0, least_share * static_cast<double>(own_.voxels)));
    return share(static_cast<std::size_t>(std::ranges::count(set, std::uint8_t{1})));
  }

  /// A fit follows a narrow tunnel, and leaves thin bars out. A ball that does not enter the one, and has no room in
  /// the other, tells them from the expected shape's own. Adds the tunnels to `hole`. `line`: parts of bars that are
  /// long, however thin.
  void find_tunnels_and_bars(std::vector<std::uint8_t>& hole, std::vector<std::uint8_t>& bar,
                             std::vector<std::uint8_t>& line, std::vector<std::uint8_t>& filled) {
    constexpr double ball = 0.14, deep_in_closed = 0.08, deep_in_expected = 0.03,
                     off_both = 0.06;  // shares of the size
    const double ball_mm = ball * size_mm_, off_mm = std::max(off_both * size_mm_, coarse_mm());
    // The outermost voxels are a voxel deep, and say nothing.
    const double closed_mm = std::max(deep_in_closed * size_mm_, coarse_mm()),
                 expected_mm = std::max(deep_in_expected * size_mm_, coarse_mm());
    const Body& expected = *here_;
    const Body wide(voxels_where([&](std::size_t v) { return own_.to[v] <= ball_mm; }), there_.grid);
    const Body closed(voxels_where([&](std::size_t v) {
                        return own_.inside[v] != 0 || (wide.inside[v] != 0 && wide.depth[v] > ball_mm);
                      }),
                      there_.grid);
    filled = voxels_where([&](std::size_t v) { return closed.inside[v] != 0 && expected.inside[v] != 0; });
    auto tunnel = voxels_where([&](std::size_t v) {
      return there_.labels[v] == 0 && filled[v] != 0 && closed.depth[v] > closed_mm && expected.depth[v] > expected_mm;
    });
    leave_cavities(tunnel);
    signs_.tunnels = share_of_large(tunnel);
    const Body thick(voxels_where([&](std::size_t v) { return own_.inside[v] != 0 && own_.depth[v] > ball_mm; }),
                     there_.grid);
    bar = voxels_where([&](std::size_t v) {
      return main_[v] != 0 && thick.to[v] > ball_mm && fit_.inside[v] == 0 && fit_.to[v] > off_mm &&
             expected.inside[v] == 0 && expected.to[v] > off_mm;
    });
    line = long_parts(bar);
    signs_.bars = share_of_large(bar);
    for (std::size_t v = 0; v < bar.size(); ++v) line[v] = bar[v] != 0 ? 0 : line[v];
    for (std::size_t v = 0; v < main_.size(); ++v) hole[v] |= tunnel[v];
  }

  /// The parts of bars that jut far out of the fit and of the expected shape. Notes how far the longest does.
  std::vector<std::uint8_t> long_parts(const std::vector<std::uint8_t>& bars) {
    constexpr double far = 0.15;  // of the size
    const auto parts = connected_components(bars, there_.grid.dims, Touching::faces_and_edges);
    std::vector<double> reach(parts.sizes.size());
    for (std::size_t v = 0; v < bars.size(); ++v)
      if (parts.part[v] >= 0) {
        double& farthest = reach[parts.part[v]];
        farthest = std::max(farthest, static_cast<double>(std::min(fit_.to[v], here_->to[v])) / size_mm_);
      }
    for (const double one : reach) signs_.bar_reach = std::max(signs_.bar_reach, one);
    return voxels_where([&](std::size_t v) { return parts.part[v] >= 0 && reach[parts.part[v]] >= far; });
  }

  void compare_with_expected() {
    const Body& expected = *here_;
    const double all = volume_mm3(*expected_[of_]) / there_.grid.voxel_volume_mm3();
    signs_.beyond = std::max(0.0, 1 - static_cast<double>(expected.voxels) / all);
    signs_.volume = std::log(static_cast<double>(own_.voxels) / std::max(1.0, all));
    const double far_mm = std::max(far_from_expected * size_mm_, coarse_mm());
    std::map<int, std::size_t> foreign;
    std::vector<std::uint8_t> lacking(main_.size());
    for (std::size_t v = 0; v < main_.size(); ++v) {
      if (expected.inside[v] == 0) continue;
      const int held = there_.labels[v];
      lacking[v] = held == 0 && own_.to[v] > far_mm ? 1 : 0;
      if (held != 0 && held != value_) ++foreign[held];
    }
    const double whole = std::max(1.0, static_cast<double>(expected.voxels));
    signs_.lacking = static_cast<double>(std::ranges::count(lacking, std::uint8_t{1})) / whole;
    constexpr double large_part = 0.01;
    lacking = large_parts(std::move(lacking), there_.grid, large_part * whole);
    for (std::size_t v = 0; v < lacking.size(); ++v)
      if (lacking[v] != 0) signs_.gap = std::max(signs_.gap, own_.to[v] / size_mm_);
    for (std::size_t n = 0; n < subject_.structures.size(); ++n) {
      const StructureInMap& other = subject_.structures[n];
      if (n == of_ || !other.is_there()) continue;
      constexpr double least_share = 0.02;
      const int label = label_around(subject_, of_, n);
      const auto held = foreign.find(label);
      if (held == foreign.end() || static_cast<double>(held->second) < least_share * whole) continue;
      // Where nothing is expected of the other one, only what lies deep within this one is lost.
      const std::optional<Body> theirs =
          expected_[n] ? std::optional<Body>(std::in_place, voxelise(*expected_[n], there_.grid), there_.grid)
                       : std::nullopt;
      const double clear_mm = theirs ? 0.5 * far_mm : far_mm;
      std::size_t lost = 0;
      for (std::size_t v = 0; v < main_.size(); ++v) {
        if (there_.labels[v] != label || expected.inside[v] == 0) continue;
        const double nearer_mm = (theirs ? theirs->signed_mm(v) : 0) - expected.signed_mm(v);
        if (nearer_mm > clear_mm) ++lost;
      }
      // Of a gland as small as that a few voxels at its surface are much, and tell nothing.
      constexpr std::size_t few = 12;
      if (lost > few) signs_.lost_to[n] = static_cast<double>(lost) / whole;
    }
  }

  const SetInMap& subject_;
  const std::vector<std::optional<Mesh>>& expected_;
  std::size_t of_;
  int value_;
  const VolumeGeometry& map_;
  bool empty_beyond_;  ///< Volume::empty_beyond_slices
  Neighbourhood there_;
  Body own_, fit_;
  std::optional<Body> here_;  ///< the expected shape, where there is one
  double size_mm_;
  std::vector<std::uint8_t> main_;  ///< its largest part
  StructureSigns signs_;
};

}  // namespace

std::vector<StructureSigns> structure_signs(const SetOfTemplates& set, const VolumeRead& map, int frame,
                                            const SetInMap& subject, const FittedSet& fitted,
                                            const std::vector<std::optional<Mesh>>& expected,
                                            const Progress* progress) {
  std::vector<StructureSigns> signs(set.templates.size());
  for_each_in_parallel(signs.size(), [&](std::size_t k) {
    const auto& fit = fitted.structures[k].fit;
    if (!fit || (progress != nullptr && progress->cancelled())) return;
    signs[k] = Signs(subject, expected, k, fit->mesh, map, frame).find();
  });
  std::vector<double> volumes;
  for (std::size_t k = 0; k < signs.size(); ++k)
    if (fitted.structures[k].fit && expected[k]) volumes.push_back(signs[k].volume);
  if (volumes.empty()) return signs;
  const double usual = median_of(volumes);
  for (std::size_t k = 0; k < signs.size(); ++k)
    if (fitted.structures[k].fit && expected[k]) signs[k].volume -= usual;
  return signs;
}

}  // namespace homolog
