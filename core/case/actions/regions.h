#pragma once

#include <string>

#include "core/case/actions/kind.h"

namespace homolog {

/// Brings the vertices under the brush into a named region and gives them its factor. Without a name it takes them out
/// of every region; their factor is 1 then.
struct PaintRegion {
  std::string name;
  Vec3 at = Vec3::Zero();
  double radius_mm = 10, soft = 0;
  bool operator==(const PaintRegion&) const = default;
};
const ActionKind<PaintRegion>& action_kind(const PaintRegion&);

/// Brings all vertices that are connected with the one nearest to `at` into a region. By::region takes those of the
/// same region; By::curvature takes of these only the ones whose mean curvature differs by at most a tolerance.
struct FillRegion {
  enum class By { region, curvature };
  std::string name;
  Vec3 at = Vec3::Zero();
  By by = By::region;
  double tolerance_per_mm = 0.05;
  bool operator==(const FillRegion&) const = default;
};
const ActionKind<FillRegion>& action_kind(const FillRegion&);

/// Adds a region, or gives the one of that name another factor and colour. The factors of its vertices change by the
/// same ratio.
struct SetRegion {
  Region region;
  bool operator==(const SetRegion&) const = default;
};
const ActionKind<SetRegion>& action_kind(const SetRegion&);

struct RenameRegion {
  std::string name, to;
  bool operator==(const RenameRegion&) const = default;
};
const ActionKind<RenameRegion>& action_kind(const RenameRegion&);

/// Removes a region; its vertices keep their factors.
struct RemoveRegion {
  std::string name;
  bool operator==(const RemoveRegion&) const = default;
};
const ActionKind<RemoveRegion>& action_kind(const RemoveRegion&);

}  // namespace homolog
