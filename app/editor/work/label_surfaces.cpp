#include "app/editor/work/label_surfaces.h"

#include <algorithm>
#include <utility>

#include "app/editor/work/fitter.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/label_surface.h"

namespace homolog {

int label_in_hand(const FitSettings& settings, const std::vector<int>& known, const Volume& labels,
                  const std::optional<ShapeView>& shown) {
  if (known.size() < 2) return known.empty() ? settings.label : known.front();
  if (settings.all_labels) return every_label;
  if (std::find(known.begin(), known.end(), settings.label) != known.end()) return settings.label;
  // Without a mesh nobody has asked for one yet.
  if (!shown) return settings.label;
  const int there = label_at_mesh(labels, shown->frame, *shown->shape.points);
  return there != 0 ? there : known.front();
}

const LabelSurfaces::Made* LabelSurfaces::found(const Wanted& wanted) const {
  const auto one = std::find_if(made_.begin(), made_.end(), [&](const Made& made) { return made.of == wanted; });
  return one == made_.end() ? nullptr : &*one;
}

void LabelSurfaces::want(std::optional<Wanted> wanted) {
  if (wanted == wanted_) return;
  worker_.cancel();
  wanted_ = std::move(wanted);
  if (!wanted_) return made_.clear();
  // Surfaces of another map are not wanted again soon, and hold it.
  std::erase_if(made_, [&](const Made& made) { return made.of.labels != wanted_->labels; });
  if (found(*wanted_) != nullptr) return;
  const std::string name = wanted_->label == every_label ? "all labels" : label_name(wanted_->label);
  worker_.start(name, [of = *wanted_](Progress& progress) -> Result<Made> {
    auto surface = label_surface(*of.labels, of.label, of.frame, &progress);
    return Made{of, surface ? std::make_shared<const Mesh>(std::move(*surface)) : nullptr};
  });
}

bool LabelSurfaces::update() {
  auto done = worker_.take();
  if (!done) return false;
  // Where it failed nothing is shown, and it is not tried again.
  made_.push_back(*done ? std::move(**done) : Made{wanted_.value_or(Wanted{}), nullptr});
  constexpr std::size_t most = 24;  // the frames of a heart
  if (made_.size() > most) made_.pop_front();
  return true;
}

std::shared_ptr<const Mesh> LabelSurfaces::shown() const {
  const Made* made = wanted_ ? found(*wanted_) : nullptr;
  return made != nullptr ? made->mesh : nullptr;
}

}  // namespace homolog
