#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/gl.h"
#include "render/projection.h"
#include "render/scene.h"

namespace homolog {

/// Shaded surfaces in the 3D view.
class MeshPass {
 public:
  static Result<MeshPass> make();
  /// Uploads what changed in the meshes of the scene; the draws that follow show these.
  void update(const std::vector<MeshLayer>& meshes);
  void draw_opaque(const Projection& projection);
  /// Of the opaque ones what the depth that was drawn hides, seen through it: faintly, and without depth of its own.
  /// Before draw_opaque().
  void draw_hidden(const Projection& projection);
  /// The far side first, then the nearest layer of the near side. Several surfaces are drawn from far to near, an
  /// enclosing one after what it encloses.
  void draw_transparent(const Projection& projection);

 private:
  /// What was uploaded last; an object that lives cannot share its address with another.
  template <class T>
  struct Uploaded {
    std::weak_ptr<const T> owner;
    std::uint64_t revision = 0;
    enum class Was { nothing, null, something } was = Was::nothing;
    /// Whether `now` is another object or revision than the last time; remembers it.
    bool update(const std::shared_ptr<const T>& now, std::uint64_t now_revision = 0);
  };
  struct Surface {
    gl::VertexArray attributes;
    gl::Buffer points_and_normals, colours, triangles;
    Uploaded<Topology> topology;
    Uploaded<Points> points;
    Uploaded<std::vector<Rgb>> colour_values;
    GLsizei indices = 0;
    Box box;
    double edge_mm = 0;  ///< mean length
    bool shown = false, faces = false, edges = false;
    float opacity = 1;
  };
  static Surface make_surface();
  void update(Surface& surface, const MeshLayer& mesh);
  void draw_triangles(const gl::Program& program, const Surface& surface, const Projection& projection,
                      float opacity) const;
  void draw_edges(const Surface& surface, const Projection& projection) const;
  void draw_transparent(const Surface& surface, const Projection& projection) const;

  gl::Program faces_, edges_;
  std::vector<Surface> surfaces_;  ///< by the index of the layer
};

}  // namespace homolog
