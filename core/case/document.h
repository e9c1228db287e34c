#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/case/structure.h"
#include "core/deform/stroke.h"
#include "core/volume/volume.h"

namespace homolog {

/// The scan.
struct Scan {
  std::string source;                   ///< path, or the name of a phantom [core/catalogue]; empty without an image
  std::shared_ptr<const Volume> image;  ///< null: none

  /// How many frames there are: 1 without an image.
  int frames() const { return image ? image->frames : 1; }
};

/// Everything of a case that is saved, as a value: a copy is a few reference counts, and undo keeps copies.
struct Document {
  Scan scan;
  std::vector<std::shared_ptr<const Structure>> structures;  ///< none until a template is loaded; never null
  int frame = 0;                                             ///< the one that is shown

  Scheme scheme = Scheme::anchored;
  int paper_events = 1;     ///< mouse events a stroke counts for in the scheme `paper`
  double even_spacing = 0;  ///< strength 0…1 of keeping vertices evenly spread along with an edit

  /// A structure by its id; the empty id is the first structure's. Null: there is none.
  const Structure* structure(std::string_view id = {}) const;
  /// The same structure at the shown frame; none where it has no mesh there.
  std::optional<ShapeView> view(std::string_view id = {}) const;
  /// Changes a structure that there is: `change` gets a copy of it, since other documents share the old one.
  template <class Change>
  void change(std::string_view id, const Change& change) {
    auto& shared = structures.at(index_of(id));
    Structure changed = *shared;
    change(changed);
    shared = std::make_shared<const Structure>(std::move(changed));
  }
  /// Lets placed landmarks hold the mesh, in all structures.
  void hold_landmarks();

 private:
  std::size_t index_of(std::string_view id) const;
};

/// An id that no curves of the case have, of any structure: "c1".
std::string free_contour_id(const Document& document);

/// A case without edits: the template at `placement`; without one in the middle of the volume, upright, at its own
/// size. Volume and template may be null. Never fails.
Document new_document(std::string volume_source, std::shared_ptr<const Volume> volume,
                      std::shared_ptr<const Template> the_template, const std::optional<Similarity>& placement = {});

}  // namespace homolog
