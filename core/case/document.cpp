#include "core/case/document.h"

#include <algorithm>

#include "core/case/placing.h"

namespace homolog {

std::size_t Document::index_of(std::string_view id) const {
  if (id.empty()) return 0;
  const auto has_id = [&](const auto& structure) { return structure->id == id; };
  return static_cast<std::size_t>(std::find_if(structures.begin(), structures.end(), has_id) - structures.begin());
}

const Structure* Document::structure(std::string_view id) const {
  const std::size_t index = index_of(id);
  return index < structures.size() ? structures[index].get() : nullptr;
}

std::optional<ShapeView> Document::view(std::string_view id) const {
  const Structure* found = structure(id);
  const Shape* shape = found != nullptr ? found->shape(frame) : nullptr;
  if (shape == nullptr) return std::nullopt;
  return ShapeView{*found, *shape, frame};
}

void Document::hold_landmarks() {
  for (auto& shared : structures) {
    Structure held = *shared;
    held.landmarks.hold = true;
    shared = std::make_shared<const Structure>(std::move(held));
  }
}

std::string free_contour_id(const Document& document) {
  for (int number = 1;; ++number) {
    std::string id = "c" + std::to_string(number);
    if (std::none_of(document.structures.begin(), document.structures.end(),
                     [&](const auto& structure) { return structure->contour_set(id) != nullptr; }))
      return id;
  }
}

Document new_document(std::string volume_source, std::shared_ptr<const Volume> volume,
                      std::shared_ptr<const Template> the_template, const std::optional<Similarity>& placement) {
  Document document;
  document.scan = {std::move(volume_source), std::move(volume)};
  if (!the_template) return document;
  const Similarity where = placement.value_or(in_the_middle(document.scan, *the_template));
  document.structures.push_back(std::make_shared<const Structure>(new_structure(std::move(the_template), where)));
  return document;
}

}  // namespace homolog
