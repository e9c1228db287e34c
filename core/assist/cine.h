#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/adapt/propagate.h"
#include "core/case/action.h"
#include "core/case/document.h"

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

/// The wall between a cavity and the structure around it, as between endocardium and epicardium.
struct WallOfFrame {
  double volume_ml = 0;     ///< the volume in the outer mesh less that in the inner one
  double thickness_mm = 0;  ///< median over the inner mesh's vertices of how far the outer surface is
  double mass_g() const { return 1.05 * volume_ml; }  ///< with the density of heart muscle, 1.05 g/ml
};

/// The volume that the mesh encloses, frame by frame. Frames whose mesh nobody has edited or carried there are left
/// out.
struct VolumeCurve {
  struct Frame {
    std::shared_ptr<const Points> points;
    double volume_ml = 0;
    bool known = false;                          ///< a person made it
    std::string doubt;                           ///< why it has to be looked at; empty where it need not
    std::optional<WallOfFrame> wall{};           ///< set where both its structures have a mesh
    std::shared_ptr<const Points> inner, outer;  ///< the wall's meshes
  };
  std::map<int, Frame> frames;
  std::optional<Ejection> ejection;  ///< found by the frames that are in no doubt; none where there are fewer than two
  std::string inner, outer;          ///< the structures of the wall, by their ids; empty: there is none
  std::vector<std::shared_ptr<const Points>> looked_at;  ///< the meshes among which no wall was found
};
/// `structure` is one of the document's. Its wall is that to the nearest structure that lies around it in the first
/// frame that was edited (all but 2 % of the inner one's vertices within 0.5 mm of its inside), or that it lies around,
/// where the cavity is a fifth of the whole or more. `before`: of an earlier state of the case; its figures serve again
/// where the meshes are still the same.
VolumeCurve volume_curve(const Document& document, const Structure& structure, const VolumeCurve& before = {});

/// The curve as a CSV table: frame, seconds, volume_ml, known, doubt; with a wall also wall_ml, wall_mm, mass_g.
std::string volume_table(const VolumeCurve& curve, double frame_seconds);

}  // namespace homolog
