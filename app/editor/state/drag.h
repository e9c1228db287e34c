#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/editor/state/view_geometry.h"
#include "core/case/action.h"

namespace homolog {

enum class MouseButton { left, right, middle };

/// Parts of the placement handles: the mesh itself (moves), the ring (turns), the knob (scales).
enum class PlacePart { none, body, ring, knob };

// A drag knows where it started, and what follows from the cursor is absolute: dropping an event loses nothing.

struct PanDrag {
  ViewKind view = ViewKind::axial;
  double x_px = 0, y_px = 0;
  Vec3 start_mm = Vec3::Zero();  ///< centre of the view (target of the camera) when it started
};
struct WindowLevelDrag {
  double x_px = 0, y_px = 0, low = 0, high = 1;
};
struct TurnDrag {
  double x_px = 0, y_px = 0;
  Camera3D start;
};
struct StrokeDrag {
  ViewKind view = ViewKind::axial;
  Stroke stroke;
  Vec3 press_mm = Vec3::Zero();  ///< cursor when it started; the stroke moves by how far the cursor moved since
  bool moved = false;
};
struct PlaceDrag {
  ViewKind view = ViewKind::axial;
  PlacePart part = PlacePart::body;
  Similarity start, now;
  Vec3 centre_mm = Vec3::Zero(), press_mm = Vec3::Zero();
};
struct LandmarkDrag {
  ViewKind view = ViewKind::axial;
  std::string name;
  Vec3 to = Vec3::Zero();
  Vec3 from_pointer = Vec3::Zero();  ///< the place at which a landmark that was placed before was taken hold of
  bool moved = true;                 ///< false until such a one has left its place
};
/// Puts dabs of a brush along the pointer's path, evenly, however many events tell of it; every dab is an action.
struct BrushDrag {
  ViewKind view = ViewKind::axial;
  double x_px = 0, y_px = 0;  ///< the place that the path has come to
  double to_next_px = 0;      ///< along the path, until the next dab
  bool painted = false;       ///< a dab met the mesh
  bool reversed = false;      ///< Alt: frees where the brush holds
  /// Until then it may be the first press of a double click, and paints nothing while the pointer stays.
  std::optional<double> waits_until;
};
struct RulerDrag {
  ViewKind view = ViewKind::axial;
};

/// A contour of the case, held where a stroke begins that may draw a part of it anew.
struct HeldContour {
  std::string id;             ///< its set's id
  int number = 0;             ///< the curve's number in the set
  Contour curve;              ///< the curve as it was before
  Vec3 at = Vec3::Zero();     ///< the place of it, LPS mm
  Vec3 aside = Vec3::Zero();  ///< the way from the slice to the plane in which it lies, mm
  double near_mm = 0;         ///< so near to it a stroke begins and ends that draws a part anew
};

/// A curve that is drawn by hand in a slice.
struct ContourDrag {
  ViewKind view = ViewKind::axial;
  std::string id;                     ///< the id that the curve gets
  std::vector<Vec3> points;           ///< along the pointer's path, in the plane of the slice
  double x_px = 0, y_px = 0;          ///< the place of the last of them
  bool at_start = false;              ///< the pointer came back to where it began: the curve is closed
  bool is_wide = false;               ///< the pointer went far from where it began
  std::optional<HeldContour> held{};  ///< the one it began at: if it ends there too, it draws a part of that anew
};

/// The click's request, while another press may still make it a double click, which edits nothing.
struct HeldClick {
  std::optional<Action> action;
  std::string notice;  ///< the reason why there is no action
  double until = 0;    ///< its end by the clock of the events
};

using Drag = std::variant<PanDrag, WindowLevelDrag, TurnDrag, StrokeDrag, PlaceDrag, LandmarkDrag, BrushDrag, RulerDrag,
                          ContourDrag>;
/// Whether a drag moves a view; else it is a tool's.
inline bool is_of_view(const Drag& drag) {
  return std::holds_alternative<PanDrag>(drag) || std::holds_alternative<WindowLevelDrag>(drag) ||
         std::holds_alternative<TurnDrag>(drag);
}

}  // namespace homolog
