#include "render/mesh_pass.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/mesh/mesh_quality.h"
#include "render/shaders.h"

namespace homolog {
namespace {

constexpr std::uint64_t mesh_budget_bytes = std::uint64_t{256} << 20;

/// Distance from the eye to the nearest corner of a box, along the line of sight; mm.
float nearest_depth_mm(const Box& box, const Projection& projection) {
  float depth = std::numeric_limits<float>::max();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p_mm = box.corner(static_cast<Box::CornerType>(corner));
    depth = std::min(depth, -(projection.eye_from_mm * glm::vec4(to_glm(p_mm), 1)).z);
  }
  return depth;
}

/// px that a mm in the middle of a box takes on the screen.
float px_per_mm(const Box& box, const Projection& projection) {
  const glm::vec4 clip = projection.clip_from_eye * projection.eye_from_mm * glm::vec4(to_glm(box.center()), 1);
  return projection.clip_from_eye[1][1] * projection.size_px.y / 2 / clip.w;
}

}  // namespace

template <class T>
bool MeshPass::Uploaded<T>::update(const std::shared_ptr<const T>& now, std::uint64_t now_revision) {
  const Was is = now != nullptr ? Was::something : Was::null;
  const bool same = was == is && (is == Was::null || (owner.lock() == now && revision == now_revision));
  was = is;
  owner = now;
  revision = now_revision;
  return !same;
}

Result<MeshPass> MeshPass::make() {
  auto faces = gl::Program::make(shaders::mesh_vert(), shaders::mesh_frag(), shaders::light_glsl());
  if (!faces) return fail(faces.error());
  auto edges = gl::Program::make(shaders::mesh_vert(), shaders::mesh_frag(), "#define EDGES\n");
  if (!edges) return fail(edges.error());
  MeshPass pass;
  pass.faces_ = std::move(*faces);
  pass.edges_ = std::move(*edges);
  return pass;
}

MeshPass::Surface MeshPass::make_surface() {
  Surface surface;
  surface.attributes = gl::VertexArray::make();
  surface.points_and_normals = gl::Buffer::make();
  surface.colours = gl::Buffer::make();
  glBindVertexArray(surface.attributes.name());
  glBindBuffer(GL_ARRAY_BUFFER, surface.points_and_normals.name());
  gl::attribute(0, 3, 6 * sizeof(float), 0, 0);
  gl::attribute(1, 3, 6 * sizeof(float), 3 * sizeof(float), 0);
  glBindBuffer(GL_ARRAY_BUFFER, surface.colours.name());
  gl::attribute(2, 3, sizeof(Rgb), 0, 0);
  glBindVertexArray(0);
  return surface;
}

void MeshPass::update(const std::vector<MeshLayer>& meshes) {
  ++scenes_;
  shown_.clear();
  for (const MeshLayer& mesh : meshes) {
    if (!mesh.topology || !mesh.points || mesh.surface_opacity <= 0 || !(mesh.surface || mesh.wireframe)) continue;
    Surface& surface = surface_of(mesh);
    update(surface, mesh);
    shown_.push_back(&surface);
  }
  make_room();
}

/// The surface that holds the mesh; else one to be filled: that of points that are gone, so that a mesh that is dragged
/// takes up no more and more, or a new one. None serves two layers of a scene.
MeshPass::Surface& MeshPass::surface_of(const MeshLayer& mesh) {
  const auto is_free = [&](const Surface& surface) { return surface.scene != scenes_; };
  auto found = std::ranges::find_if(surfaces_, [&](const Surface& surface) {
    return is_free(surface) && surface.points.is(mesh.points) && surface.topology.is(mesh.topology);
  });
  if (found == surfaces_.end())
    found = std::ranges::find_if(surfaces_, [&](const Surface& surface) {
      return is_free(surface) && surface.points.owner.expired() && surface.topology.is(mesh.topology);
    });
  if (found == surfaces_.end())
    surfaces_.push_front(make_surface());
  else
    surfaces_.splice(surfaces_.begin(), surfaces_, found);
  surfaces_.front().scene = scenes_;
  return surfaces_.front();
}

void MeshPass::set_triangles(Surface& surface, const std::shared_ptr<const Topology>& topology) {
  const Triangles& triangles = topology->triangles();
  surface.indices = static_cast<GLsizei>(triangles.size());
  const auto same = std::ranges::find_if(surfaces_, [&](const Surface& other) {
    return &other != &surface && other.triangles && other.topology.is(topology);
  });
  glBindVertexArray(surface.attributes.name());
  if (same != surfaces_.end()) {
    surface.triangles = same->triangles;
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, surface.triangles->name());
  } else {
    surface.triangles = std::make_shared<gl::Buffer>(gl::Buffer::make());
    gl::upload(*surface.triangles, GL_ELEMENT_ARRAY_BUFFER,
               std::span(triangles.data(), static_cast<std::size_t>(triangles.size())), GL_STATIC_DRAW);
  }
  glBindVertexArray(0);
}

void MeshPass::make_room() {
  const auto is_idle = [&](const Surface& surface) { return surface.scene != scenes_; };
  std::erase_if(surfaces_,
                [&](const Surface& surface) { return is_idle(surface) && surface.topology.owner.expired(); });
  std::uint64_t bytes = 0;
  for (const Surface& surface : surfaces_) bytes += surface.bytes;
  while (bytes > mesh_budget_bytes && is_idle(surfaces_.back())) {
    bytes -= surfaces_.back().bytes;
    surfaces_.pop_back();
  }
}

void MeshPass::update(Surface& surface, const MeshLayer& mesh) {
  assert(mesh.points->rows() == mesh.topology->vertices());
  surface.faces = mesh.surface;
  surface.edges = mesh.wireframe;
  surface.yields = mesh.yields;
  surface.opacity = std::min(mesh.surface_opacity, 1.0f);
  const bool new_topology = surface.topology.update(mesh.topology);
  if (new_topology) set_triangles(surface, mesh.topology);
  if (surface.points.update(mesh.points, mesh.points_revision) || new_topology) {
    Eigen::Matrix<float, Eigen::Dynamic, 6, Eigen::RowMajor> vertices(mesh.points->rows(), 6);
    vertices.leftCols<3>() = mesh.points->cast<float>();
    vertices.rightCols<3>() = vertex_normals({mesh.topology, *mesh.points}).cast<float>();
    gl::upload(surface.points_and_normals, GL_ARRAY_BUFFER,
               std::span<const float>(vertices.data(), static_cast<std::size_t>(vertices.size())), GL_DYNAMIC_DRAW);
    ++uploads_;
    surface.bytes = static_cast<std::uint64_t>(vertices.size()) * sizeof(float) +
                    static_cast<std::uint64_t>(vertices.rows()) * sizeof(Rgb) +
                    static_cast<std::uint64_t>(surface.indices) * sizeof(std::uint32_t) /
                        static_cast<std::uint64_t>(surface.triangles.use_count());
    surface.box = bounds_of(*mesh.points);
    surface.edge_mm = mean_edge_mm(*mesh.topology, *mesh.points);
  }
  if (surface.colour_values.update(mesh.colours, mesh.colours_revision) || new_topology) {
    const std::vector<Rgb> plain(mesh.colours ? 0 : static_cast<std::size_t>(mesh.points->rows()), mesh_colour);
    gl::upload(surface.colours, GL_ARRAY_BUFFER, std::span<const Rgb>(mesh.colours ? *mesh.colours : plain),
               GL_DYNAMIC_DRAW);
  }
}

void MeshPass::draw_triangles(const gl::Program& program, const Surface& surface, const Projection& projection,
                              float opacity) const {
  program.use();
  program.set("eye_from_mm", projection.eye_from_mm);
  program.set("clip_from_eye", projection.clip_from_eye);
  program.set("opacity", opacity);
  // Edges only a few pixels long would hide the surface: they fade.
  const float edge_px = static_cast<float>(surface.edge_mm) * px_per_mm(surface.box, projection);
  program.set("edge_opacity", surface.opacity * std::clamp(edge_px / 30, 0.05f, 0.5f));
  glBindVertexArray(surface.attributes.name());
  if (surface.yields) {
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1, 8);  // more than what rounding makes of one place
  }
  glDrawElements(GL_TRIANGLES, surface.indices, GL_UNSIGNED_INT, nullptr);
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void MeshPass::draw_edges(const Surface& surface, const Projection& projection) const {
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glEnable(GL_POLYGON_OFFSET_LINE);
  glPolygonOffset(-1, -1);
  glDepthMask(GL_FALSE);
  draw_triangles(edges_, surface, projection, surface.opacity);
  glDepthMask(GL_TRUE);
  glDisable(GL_POLYGON_OFFSET_LINE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

void MeshPass::draw_opaque(const Projection& projection) {
  for (const Surface* surface : shown_) {
    if (surface->opacity < 1) continue;
    if (surface->faces) draw_triangles(faces_, *surface, projection, surface->opacity);
    if (surface->edges) draw_edges(*surface, projection);
  }
}

void MeshPass::draw_hidden(const Projection& projection) {
  constexpr float ghost = 0.4f;
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  for (const Surface* surface : shown_)
    if (surface->faces && surface->opacity >= 1) draw_triangles(faces_, *surface, projection, ghost);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_CULL_FACE);
}

void MeshPass::draw_transparent(const Projection& projection) {
  std::vector<const Surface*> far_to_near;
  for (const Surface* surface : shown_)
    if (surface->opacity < 1) far_to_near.push_back(surface);
  std::stable_sort(far_to_near.begin(), far_to_near.end(), [&](const Surface* a, const Surface* b) {
    return nearest_depth_mm(a->box, projection) > nearest_depth_mm(b->box, projection);
  });
  for (const Surface* surface : far_to_near) draw_transparent(*surface, projection);
}

void MeshPass::draw_transparent(const Surface& surface, const Projection& projection) const {
  glEnable(GL_CULL_FACE);
  if (surface.faces) {
    glCullFace(GL_FRONT);
    glDepthMask(GL_FALSE);
    draw_triangles(faces_, surface, projection, surface.opacity);
    glDepthMask(GL_TRUE);
    glCullFace(GL_BACK);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_triangles(faces_, surface, projection, surface.opacity);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    draw_triangles(faces_, surface, projection, surface.opacity);
  }
  glCullFace(GL_BACK);
  if (surface.edges) draw_edges(surface, projection);
  glDisable(GL_CULL_FACE);
}

}  // namespace homolog
