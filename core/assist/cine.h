#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/adapt/propagate.h"
#include "core/case/action.h"

namespace homolog {

// A cine as a case: its meshes are carried from frame to frame, a person corrects some, and they are carried again.

/// The frames whose meshes a propagation starts from and keeps: the known ones [frame_is_known]; where there are none,
/// the one that is shown.
std::vector<int> starting_frames(const ShapeView& shown);

struct CineEdit {
  std::vector<SetPoints> actions;  ///< one for each frame that changes, to be undone together
  Propagation result;
};

/// Carries the meshes of the starting frames through the case's cine [propagate.h]. `options.known` is not used.
/// Errors: no mesh, no image, and those of propagate().
Result<CineEdit> propagate_shape(const Scan& scan, const ShapeView& shown, const PropagateOptions& options);

/// The volume that the mesh encloses, frame by frame. Frames whose mesh nobody has edited or carried there are left
/// out.
struct VolumeCurve {
  struct Frame {
    std::shared_ptr<const Points> points;
    double volume_ml = 0;
    bool known = false;  ///< a person made it
    std::string doubt;   ///< why it has to be looked at; empty where it need not
  };
  std::map<int, Frame> frames;
  std::optional<Ejection> ejection;  ///< of the frames that are in no doubt; none where there are fewer than two
};
/// `before`: of an earlier state of the case; its volumes serve again where the mesh is still the same.
VolumeCurve volume_curve(const Structure& structure, const VolumeCurve& before = {});

/// The curve as a CSV table: frame, seconds, volume_ml, known, doubt.
std::string volume_table(const VolumeCurve& curve, double frame_seconds);

}  // namespace homolog
