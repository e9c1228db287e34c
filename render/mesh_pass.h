#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <vector>

#include "render/gl.h"
#include "render/projection.h"
#include "render/scene.h"

namespace homolog {

/// Shaded surfaces in the 3D view. A mesh that was drawn stays on the GPU under its identity, wherever it stands in the
/// scene, and the least recently drawn goes first beyond a budget: a gallery within the budget
/// that is drawn again uploads nothing.
class MeshPass {
 public:
  static Result<MeshPass> make();
  /// Uploads what is not there yet of the meshes of the scene; the draws that follow show these.
  void update(const std::vector<MeshLayer>& meshes);
  /// How many times points were uploaded so far.
  std::size_t uploads() const { return uploads_; }
  std::size_t kept() const { return surfaces_.size(); }  ///< meshes on the GPU
  void draw_opaque(const Projection& projection);
  /// Draws what the depth that was drawn hides of the opaque ones, seen through it: faintly, and without depth of its
  /// own. Call it before draw_opaque().
  void draw_hidden(const Projection& projection);
  /// The far side first, then the nearest layer of the near side. Several surfaces are drawn from far to near, an
  /// enclosing one after what it encloses.
  void draw_transparent(const Projection& projection);

 private:
  /// The object that was uploaded last; an object that lives cannot share its address with another.
  template <class T>
  struct Uploaded {
    std::weak_ptr<const T> owner;
    std::uint64_t revision = 0;
    enum class Was { nothing, null, something } was = Was::nothing;
    /// Whether `now` is another object or revision than the last time; remembers it.
    bool update(const std::shared_ptr<const T>& now, std::uint64_t now_revision = 0);
    bool is(const std::shared_ptr<const T>& other) const { return was == Was::something && owner.lock() == other; }
  };
  struct Surface {
    gl::VertexArray attributes;
    gl::Buffer points_and_normals, colours;
    std::shared_ptr<gl::Buffer> triangles;  ///< the topology's triangles; its surfaces share them
    Uploaded<Topology> topology;
    Uploaded<Points> points;
    Uploaded<std::vector<Rgb>> colour_values;
    GLsizei indices = 0;
    Box box;
    double edge_mm = 0;  ///< mean length
    bool faces = false, edges = false, yields = false;
    float opacity = 1;
    std::uint64_t bytes = 0;  ///< bytes on the GPU
    std::uint64_t scene = 0;  ///< the last one that it was in
  };
  static Surface make_surface();
  Surface& surface_of(const MeshLayer& mesh);
  void set_triangles(Surface& surface, const std::shared_ptr<const Topology>& topology);
  void make_room();
  void update(Surface& surface, const MeshLayer& mesh);
  void draw_triangles(const gl::Program& program, const Surface& surface, const Projection& projection,
                      float opacity) const;
  void draw_edges(const Surface& surface, const Projection& projection) const;
  void draw_transparent(const Surface& surface, const Projection& projection) const;

  gl::Program faces_, edges_;
  std::list<Surface> surfaces_;  ///< most recently drawn first
  std::vector<Surface*> shown_;  ///< in the order of the layers
  std::uint64_t scenes_ = 0;
  std::size_t uploads_ = 0;
};

}  // namespace homolog
