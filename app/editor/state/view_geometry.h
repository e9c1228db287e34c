#pragma once

#include <array>
#include <string>

#include "core/volume/volume.h"
#include "render/scene.h"

namespace homolog {

/// The four views of the window, in reading order.
enum class ViewKind { axial, sagittal, coronal, space };
inline constexpr std::array<ViewKind, 4> all_views{ViewKind::axial, ViewKind::sagittal, ViewKind::coronal,
                                                   ViewKind::space};
inline constexpr std::array<ViewKind, 3> slice_views{ViewKind::axial, ViewKind::sagittal, ViewKind::coronal};
inline std::size_t index_of(ViewKind kind) {
  return static_cast<std::size_t>(kind);
}

/// The axes that slices are parallel to, as columns near patient x, y, z: the identity, or the volume's own
/// directions, permuted and turned so that they lie closest to it.
Mat3 slice_axes(const VolumeGeometry& geometry, bool own_planes);

/// Whether the volume's own planes differ from the patient's.
inline bool is_oblique(const VolumeGeometry& geometry) {
  return !slice_axes(geometry, true).isIdentity(1e-3);
}

/// Right and down on the screen of a slice view. Radiological: the patient's right is on the screen's left, axial
/// slices are seen from the feet, coronal ones from the front; else left and right are exchanged. Sagittal slices
/// have anterior on the left either way.
struct ScreenAxes {
  Vec3 right, down;
  Vec3 normal() const { return right.cross(down); }
};
ScreenAxes screen_axes(ViewKind kind, const Mat3& axes, bool radiological);

/// "Axial", or for a volume's own planes which of its axes the view looks along ("Plane across k").
std::string view_title(ViewKind kind, const VolumeGeometry& geometry, bool own_planes);

/// Letters of a direction in the patient, the strongest first: "L", or "LP" where a second one is at least 22.5° off.
std::string direction_letters(const Vec3& direction);

/// "R 17.6 P 35.3 S 12.1", mm.
std::string position_text(const Vec3& p_mm);

/// Distance between neighbouring slices along a unit direction: the spacing where it runs along an axis of the grid.
double slice_step_mm(const VolumeGeometry& geometry, const Vec3& direction);

/// Standard directions to look from.
enum class LookFrom { anterior, posterior, left, right, superior, inferior };
inline constexpr std::array<const char*, 6> side_names{"anterior", "posterior", "left",
                                                       "right",    "superior",  "inferior"};
/// Keys, with Shift, and buttons have these letters.
inline constexpr std::array<char, 6> side_letters{'A', 'P', 'L', 'R', 'S', 'I'};
Camera3D camera_from(LookFrom from, const Box& box_mm);
/// Turns the camera about its target to that side; its distance stays.
void look_from(Camera3D& camera, LookFrom from);
/// Turned about its target as a trackball by a movement of the mouse.
Camera3D turned(const Camera3D& camera, double right_px, double down_px);
/// Turns the camera so that it looks straight onto a surface with this normal; a zero normal turns nothing.
void look_from_outside(Camera3D& camera, const Vec3& normal);
/// Right direction on the screen.
inline Vec3 camera_right(const Camera3D& camera) {
  return camera.up.cross(camera.to_eye);
}
/// mm that one px covers at the target, for a view whose shorter side is `side_px`.
double camera_mm_per_px(const Camera3D& camera, double side_px);

}  // namespace homolog
