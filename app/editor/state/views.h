#pragma once

#include <cstdint>
#include <vector>

#include "app/editor/state/state.h"
#include "render/scene.h"

namespace homolog {

// The views of the case: the planes of the slices, the camera of the 3D view, how near both look.

/// The plane of a slice view.
SliceView slice_view(const EditorState& state, ViewKind kind, const VolumeGeometry& geometry);

/// The next look of the slices in the 3D view; after the last they are off.
ShownParts with_next_planes(ShownParts parts);

/// The slice planes that the 3D view shows; none where they are switched off.
std::vector<PlaneInSpace> shown_planes(const EditorState& state, const Document& document);

/// The volume's geometry; a box around the meshes where there is no volume.
VolumeGeometry geometry_of(const Document& document);

/// The cross-hair goes to the middle of the structure that is worked on, where its box does not hold it. Slices that
/// do not show that place go there too.
void bring_into_view(EditorState& state, const Document& document);
/// Brings the slices to the guide's step, where there is one to do.
void look_at_step(EditorState& state);
/// Brings the cross-hair, the middle of every slice view and the 3D view close to a point of the mesh, seen from
/// outside.
void look_closely(EditorState& state, const Mesh& mesh, std::int32_t vertex);
/// Brings the cross-hair and the 3D view to a mesh; the slices show as much as before.
void look_at_mesh(EditorState& state, const Points& points);
void show_all(EditorState& state, const Document& document, const Layout& layout);
/// Slices show as much of the image after their view has grown or shrunk: maximised, or with the window.
void follow_layout(EditorState& state, const Layout& layout);

/// The cross-hair goes along the view's normal by whole slices, from the slice that is shown to the next acquired one;
/// what a touchpad gives of a step is kept for later.
void scroll_slice(EditorState& state, ViewKind kind, const Document& document, double steps);
/// Brings the cross-hair to the middle of the nearest voxel, so that slices show what was acquired and no mean of two;
/// in planes oblique to the voxels it stays where it is.
void settle_crosshair(EditorState& state, const Document& document);
/// Zooms a slice view; with linked zoom the others too, about the cross-hair.
void zoom_slice(EditorState& state, ViewKind kind, double mm_per_px);
/// From now on the slice views zoom together, beginning with the smallest scale of the three, or each by itself.
void link_zoom(EditorState& state, bool linked);

}  // namespace homolog
