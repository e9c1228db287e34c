#include "app/editor/drawing/case_thumbnails.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "render/hued_shapes.h"

namespace homolog {

namespace {

constexpr double frame_ms = 6;  ///< that a frame may spend on them
/// More points than these cannot be told apart at that size.
constexpr Eigen::Index most_dots = 400;

/// A mesh from the front, or dots where a shape is points alone. `faces`: of the shape before, used again where this
/// one has the same.
Scene scene_of(const MeshFile& shape, std::shared_ptr<const Topology>& faces) {
  Scene scene;
  scene.background = {0, 0, 0, 0};
  if (shape.triangles.rows() > 0 &&
      (!faces || faces->vertices() != shape.points.rows() || faces->triangles().rows() != shape.triangles.rows() ||
       faces->triangles() != shape.triangles))
    faces = Topology::make(shape.points.rows(), shape.triangles).value_or(nullptr);
  if (shape.triangles.rows() > 0 && faces) {
    MeshLayer layer;
    layer.topology = faces;
    // A copy that goes with the scene: else the renderer would keep the surface for the next frame.
    layer.points = std::make_shared<const Points>(shape.points);
    scene.meshes.push_back(std::move(layer));
    return scene;
  }
  const double radius_mm = 0.015 * bounds_of(shape.points).diagonal().norm();
  const Eigen::Index step = 1 + shape.points.rows() / most_dots;
  for (Eigen::Index i = 0; i < shape.points.rows(); i += step)
    scene.glyphs.glyphs.push_back({shape.points.row(i), mesh_colour, static_cast<float>(radius_mm)});
  return scene;
}

Camera3D camera_for(const Points& points) {
  const Box box = bounds_of(points);
  Camera3D camera = turned(camera_from(LookFrom::anterior, box), -40, 25);
  camera.fov_deg = 0;
  camera.target = box.center();
  camera.distance_mm = distance_that_shows(0.5 * box.diagonal().norm());
  return camera;
}

unsigned texture_of(const Picture& picture) {
  unsigned texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, picture.width, picture.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               picture.rgba.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

}  // namespace

struct CaseThumbnails::Thumbnail {
  std::shared_ptr<const MeshFile> shape;  ///< that it shows
  unsigned texture = 0;

  Thumbnail() = default;
  Thumbnail(Thumbnail&& other) noexcept : shape(std::move(other.shape)), texture(std::exchange(other.texture, 0)) {}
  ~Thumbnail() {
    if (texture != 0) glDeleteTextures(1, &texture);
  }
};

CaseThumbnails::CaseThumbnails() = default;
CaseThumbnails::~CaseThumbnails() = default;

bool CaseThumbnails::misses(const ModelsState& state, const std::string& name) const {
  const auto shape = state.shapes.shown.find(name);
  if (shape == state.shapes.shown.end()) return false;
  const auto drawn = thumbnails_.find(name);
  return drawn == thumbnails_.end() || drawn->second.shape != shape->second;
}

bool CaseThumbnails::misses_any(const ModelsState& state) const {
  return std::any_of(asked_.begin(), asked_.end(), [&](const std::string& name) { return misses(state, name); });
}

void CaseThumbnails::draw(const ModelsState& state, float scale, Renderer& renderer) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const auto width_px = static_cast<int>(std::lround(width * scale));
  const auto height_px = static_cast<int>(std::lround(height * scale));
  if (std::exchange(scale_, scale) != scale) {
    thumbnails_.clear();
    framebuffer_.reset();
  }
  std::erase_if(thumbnails_, [&](const auto& entry) { return !state.shapes.shown.contains(entry.first); });
  for (const std::string& name : std::exchange(asked_, {})) {
    if (!misses(state, name)) continue;
    if (std::chrono::duration<double, std::milli>(Clock::now() - begin).count() > frame_ms) return;
    const auto& shape = state.shapes.shown.at(name);
    Thumbnail& thumbnail = thumbnails_[name];
    thumbnail.shape = shape;
    if (!framebuffer_) {
      auto made = Framebuffer::make(width_px, height_px);
      if (!made) return;  // the list does without
      framebuffer_ = std::move(*made);
    }
    framebuffer_->bind();
    if (!renderer.draw(scene_of(*shape, faces_), camera_for(shape->points), {0, 0, width_px, height_px, scale}))
      continue;
    if (thumbnail.texture != 0) glDeleteTextures(1, &thumbnail.texture);
    thumbnail.texture = texture_of(framebuffer_->read());
  }
}

unsigned CaseThumbnails::texture(const std::string& name) const {
  asked_.insert(name);
  const auto found = thumbnails_.find(name);
  return found == thumbnails_.end() ? 0 : found->second.texture;
}

}  // namespace homolog
