#pragma once

#include <memory>
#include <string>

#include "core/model/shape_model.h"
#include "python/homolog/binding.h"

namespace homolog::python {

/// A model that Python holds. It is never changed: its arrays are views of what it holds.
struct HeldModel {
  std::shared_ptr<const ShapeModel> model;
  std::string source{};  ///< the file it was read from; empty: it was made here
  std::string record{};  ///< how it was made; empty: nobody knows
  FileStamp stamp{};     ///< the stamp of `source`
};

}  // namespace homolog::python
