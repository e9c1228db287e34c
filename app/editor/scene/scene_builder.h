#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/state.h"
#include "core/case/action.h"
#include "render/scene.h"

namespace homolog {

/// Makes scenes of what the editor shows. Keeps what takes long to compute (hues, colours, glyphs) and gives every new
/// content a revision of its own, so that the renderer uploads only what changed.
class SceneBuilder {
 public:
  struct Input {
    const EditorState& state;
    std::shared_ptr<const Document> document;  ///< the document as shown
    const std::optional<EditReport>& preview;  ///< the report on the structure that is worked on
    std::shared_ptr<const Volume> labels;
    std::shared_ptr<const Mesh> making;  ///< a template being made, shown in place of the case's mesh; null: none
    std::shared_ptr<Outlines> outlines;  ///< shared with who points at them; null: none are kept
    std::shared_ptr<const Mesh> label_surface = nullptr;                ///< the overlay's, shown in 3D; null: none
    int label = 0;                                                      ///< whose surface that is
    std::shared_ptr<const std::map<int, Rgb>> label_colours = nullptr;  ///< the colours that the map gives; null: none
  };

  /// Takes in a new moment; cheap where nothing changed.
  void update(const Input& input);
  /// The scene of a view. The 3D view has the slice planes.
  Scene scene(const Input& input, ViewKind kind) const;

 private:
  void update_mesh(const Input& input);
  void update_glyphs(const Input& input);
  void update_others(const Input& input);
  void update_label_surface(const Input& input);
  GlyphLayer glyph_layer(const Input& input) const;

  std::shared_ptr<const Template> template_;
  std::vector<float> hues_;
  std::shared_ptr<const Points> points_;
  std::uint64_t points_revision_ = 0;
  std::shared_ptr<const std::vector<Rgb>> colours_;          ///< the surface's colours
  std::shared_ptr<const std::vector<Rgb>> outline_colours_;  ///< the outlines': more saturated, tinted by a drag
  std::uint64_t colours_revision_ = 0;
  /// The things that the colours depend on.
  struct ColouredBy {
    Colouring colouring = Colouring::vertex_hue;
    Rgb own{};  ///< the structure's colour
    std::shared_ptr<const VertexScalars> response, stiffness, confirmed, outlier, confidence, z;
    std::shared_ptr<const Regions> regions;
    bool stopped = false;
    /// These are taken of the shape; null where the colouring does not follow it [kind_of].
    std::shared_ptr<const Points> points, placed, reference;
    std::shared_ptr<const VertexScalars> decided, doubt_mm;
    bool operator==(const ColouredBy&) const = default;
  };
  ColouredBy coloured_by_;
  std::shared_ptr<const Mesh> making_;
  std::shared_ptr<const Points> making_points_;
  std::shared_ptr<const Mesh> label_surface_;
  std::shared_ptr<const Points> label_points_;
  std::shared_ptr<const std::vector<Rgb>> label_colours_;
  /// A structure that is not worked on, in one colour.
  struct Other {
    std::shared_ptr<const Topology> topology;
    std::shared_ptr<const Points> points;
    Rgb colour{};
    std::shared_ptr<const std::vector<Rgb>> colours;
    std::uint64_t revision = 0;  ///< counts changes of the points and the colours
    bool as_read = false;        ///< a shape before a repair: most of it lies on the one after
  };
  std::map<std::string, Other> others_;  ///< by id
  std::vector<std::int32_t> glyphs_;
  double glyph_spacing_mm_ = 0;
};

}  // namespace homolog
