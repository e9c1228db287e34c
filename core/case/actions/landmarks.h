#pragma once

#include <optional>
#include <string>

#include "core/case/actions/kind.h"

namespace homolog {

/// Places a named landmark in the image, moves it, or (without a position) takes it away.
struct PlaceLandmark {
  std::string name;
  std::optional<Vec3> at;
  bool held = true;  ///< false: the mesh is let go there, where the case holds it
  bool operator==(const PlaceLandmark&) const = default;
};
const ActionKind<PlaceLandmark>& action_kind(const PlaceLandmark&);

struct SetLandmarkPull {
  LandmarkPull fit = LandmarkPull::warp;
  bool operator==(const SetLandmarkPull&) const = default;
};
const ActionKind<SetLandmarkPull>& action_kind(const SetLandmarkPull&);

/// Names the point of the template's surface that lies nearest to `at` on the mesh as it is now, moves that landmark,
/// or (without a position) takes it away.
struct SetTemplateLandmark {
  std::string name;
  std::optional<Vec3> at;
  bool operator==(const SetTemplateLandmark&) const = default;
};
const ActionKind<SetTemplateLandmark>& action_kind(const SetTemplateLandmark&);

}  // namespace homolog
