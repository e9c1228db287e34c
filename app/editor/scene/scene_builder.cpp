#include "app/editor/scene/scene_builder.h"

#include <algorithm>
#include <utility>

#include "app/editor/scene/mesh_colouring.h"
#include "app/editor/state/label_map_layer.h"
#include "app/editor/state/views.h"
#include "core/base/numbers/index.h"
#include "render/hued_shapes.h"
#include "render/label_colours.h"

namespace homolog {

namespace {

/// The stages before the last have far more vertices than can be told apart; the finished mesh shows its edges.
constexpr Eigen::Index wireframe_below = 12000;
constexpr float label_surface_opacity = 0.35f;  // of a label's surface: the mesh is compared with it
constexpr float other_outline_px = 1.2f;        // of a structure that is not worked on
constexpr Rgb as_read_colour{1, 1, 1};          // of one before its repair

}  // namespace

void SceneBuilder::update(const Input& input) {
  const Document& document = *input.document;
  if (input.making != making_) {
    making_ = input.making;
    making_points_ = making_ ? std::make_shared<const Points>(making_->points) : nullptr;
    ++points_revision_;
    ++colours_revision_;
  }
  update_label_surface(input);
  update_others(input);
  const Structure* structure = active_structure(input.state, document);
  if (const auto now = structure != nullptr ? structure->the_template : nullptr; now != template_) {
    template_ = now;
    hues_ = template_ ? vertex_hues(*template_->topology) : std::vector<float>();
    points_.reset();
    colours_.reset();
    glyphs_.clear();
    glyph_spacing_mm_ = 0;
  }
  if (!active_shape(input.state, document)) {
    points_.reset();
    return;
  }
  update_mesh(input);
  update_glyphs(input);
}

void SceneBuilder::update_mesh(const Input& input) {
  const ShapeView shown = *active_shape(input.state, *input.document);
  const Shape& shape = shown.shape;
  const Paint& paint = shown.paint();
  if (shape.points != points_) {
    points_ = shape.points;
    ++points_revision_;
  }
  const bool tints =
      input.preview && input.preview->response && input.preview->response->size() == shape.points->rows();
  ColouredBy by{.colouring = shown_colouring(input.state),
                .own = structure_colour(shown.structure),
                .response = tints ? input.preview->response : nullptr,
                .stiffness = paint.stiffness,
                .confirmed = shape.confirmed,
                .outlier = shape.outlier,
                .confidence = input.state.found.confidence,
                .z = input.state.scoring.z,
                .regions = paint.regions,
                .stopped = input.preview && input.preview->stopped_by_guard};
  if (kind_of(by.colouring).follows_shape) {
    // Frames may share their points but differ in what these are compared with, and in which of them are decided.
    by.points = shape.points;
    by.placed = shape.placed;
    by.reference = shape.reference;
    by.decided = shape.decided;
    by.doubt_mm = shape.doubt_mm;
  }
  if (colours_ && coloured_by_ == by) return;
  coloured_by_ = std::move(by);
  const auto colours = [&](float saturation) {
    return mesh_colours(shown, coloured_by_.colouring, hues_, saturation, coloured_by_.confidence.get(),
                        coloured_by_.z.get());
  };
  auto outline = colours(1);
  if (coloured_by_.response) outline = tinted(std::move(outline), *coloured_by_.response, coloured_by_.stopped);
  outline_colours_ = std::make_shared<const std::vector<Rgb>>(std::move(outline));
  colours_ = std::make_shared<const std::vector<Rgb>>(colours(0.4f));
  ++colours_revision_;
}

void SceneBuilder::update_label_surface(const Input& input) {
  if (input.label_surface == label_surface_) return;
  label_surface_ = input.label_surface;
  label_points_.reset();
  label_colours_.reset();
  if (!label_surface_) return;
  label_points_ = std::make_shared<const Points>(label_surface_->points);
  label_colours_ =
      std::make_shared<const std::vector<Rgb>>(static_cast<std::size_t>(label_points_->rows()),
                                               label_colour(std::max(input.label, 1), input.label_colours.get()));
}

void SceneBuilder::update_others(const Input& input) {
  const StructureLooks& looks = input.state.look.structures;
  const Structure* active = active_structure(input.state, *input.document);
  std::map<std::string, Other> before = std::exchange(others_, {});
  const auto keep = [&](const std::string& id, const auto& topology, const auto& points, const Rgb& colour,
                        bool as_read) {
    Other other = std::move(before[id]);
    if (other.topology != topology || other.colour != colour) {
      other.colours = std::make_shared<const std::vector<Rgb>>(index(topology->vertices()), colour);
      ++other.revision;
    }
    if (other.points != points) ++other.revision;
    other.topology = topology;
    other.points = points;
    other.colour = colour;
    other.as_read = as_read;
    others_[id] = std::move(other);
  };
  for (const auto& structure : input.document->structures) {
    const Shape* shape = structure->shape(input.document->frame);
    if (shape == nullptr || !looks.shows(structure->id)) continue;
    const auto& topology = structure->the_template->topology;
    if (structure.get() != active) keep(structure->id, topology, shape->points, structure_colour(*structure), false);
    const bool was_read = looks.as_read_shown && looks.as_read_frame == input.document->frame;
    if (was_read && shape_as_read(looks, *structure) != nullptr)
      keep(structure->id + " as read", topology, looks.as_read.at(structure->id), as_read_colour, true);
  }
}

void SceneBuilder::update_glyphs(const Input& input) {
  if (!input.state.preferences.show.glyphs || glyph_spacing_mm_ == input.state.look.glyph_spacing_mm) return;
  glyph_spacing_mm_ = input.state.look.glyph_spacing_mm;
  glyphs_ = glyph_vertices({template_->topology, template_->points}, glyph_spacing_mm_);
}

GlyphLayer SceneBuilder::glyph_layer(const Input& input) const {
  GlyphLayer layer;
  if (!input.state.preferences.show.glyphs || !points_ || making_ || !active_is_shown(input.state, *input.document))
    return layer;
  add_hued_glyphs(layer, *points_, glyphs_, hues_, 0.12 * input.state.look.glyph_spacing_mm);
  return layer;
}

Scene SceneBuilder::scene(const Input& input, ViewKind kind) const {
  const EditorState& state = input.state;
  const auto& show = state.preferences.show;
  const int frame = input.document->frame;
  Scene scene;
  scene.image = {input.document->scan.image, frame, state.look.window_low, state.look.window_high,
                 state.preferences.linear};
  if (input.labels) {
    scene.labels = {input.labels, frame_of_map(*input.labels, frame), static_cast<float>(state.look.label_opacity),
                    input.label_colours, state.look.hidden_labels};
  }
  if (making_) {
    MeshLayer mesh;
    mesh.topology = making_->topology;
    mesh.points = making_points_;
    mesh.points_revision = points_revision_;
    mesh.outlines = input.outlines;
    mesh.outline = mesh.surface = true;
    mesh.wireframe = show.wireframe || making_->points.rows() < wireframe_below;
    scene.meshes.push_back(std::move(mesh));
  }
  for (const auto& [id, other] : others_) {
    if (making_) break;
    MeshLayer mesh;
    mesh.topology = other.topology;
    mesh.points = other.points;
    mesh.colours = other.colours;
    mesh.points_revision = mesh.colours_revision = other.revision;
    mesh.outline = show.outline;
    mesh.outlines = input.outlines;
    mesh.outline_px = other_outline_px;
    mesh.saturated_outline = false;
    const StructureLooks& looks = state.look.structures;
    mesh.surface = show.surface;
    mesh.yields = other.as_read;
    mesh.surface_opacity = static_cast<float>(looks.others_opacity * looks.opacity_of(id));
    scene.meshes.push_back(std::move(mesh));
  }
  if (!making_ && points_ && active_is_shown(state, *input.document)) {
    MeshLayer mesh;
    mesh.topology = template_->topology;
    mesh.points = points_;
    mesh.points_revision = points_revision_;
    mesh.outlines = input.outlines;
    mesh.colours = kind == ViewKind::space ? colours_ : outline_colours_;
    mesh.colours_revision = colours_revision_;
    mesh.outline = show.outline;
    mesh.surface = show.surface;
    mesh.wireframe = show.wireframe;
    mesh.saturated_outline = false;
    const Structure* active = active_structure(state, *input.document);
    mesh.surface_opacity = static_cast<float>(state.look.structures.opacity_of(active->id));
    scene.meshes.push_back(std::move(mesh));
  }
  if (label_surface_ && kind == ViewKind::space && !making_) {
    MeshLayer label;
    label.topology = label_surface_->topology;
    label.points = label_points_;
    label.colours = label_colours_;
    label.outline = false;
    label.surface_opacity = label_surface_opacity;
    scene.meshes.push_back(std::move(label));
  }
  scene.glyphs = glyph_layer(input);
  if (kind == ViewKind::space) {
    scene.planes = shown_planes(state, *input.document);
    scene.background =
        state.preferences.light ? std::array{0.93f, 0.935f, 0.945f, 1.0f} : std::array{0.075f, 0.08f, 0.09f, 1.0f};
  }
  return scene;
}

}  // namespace homolog
