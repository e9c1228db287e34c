#pragma once

#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/base/result.h"
#include "core/model/files/hdf_tree.h"

namespace homolog::statismo {

using FloatMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Row-major floats of any matrix.
template <class Derived>
HdfTree::Dataset floats_of(const Eigen::MatrixBase<Derived>& matrix, bool as_vector = false) {
  HdfTree::Dataset dataset;
  const auto rows = static_cast<std::size_t>(matrix.rows()), columns = static_cast<std::size_t>(matrix.cols());
  dataset.dims = as_vector ? std::vector<std::size_t>{rows * columns} : std::vector<std::size_t>{rows, columns};
  std::vector<float> values(rows * columns);
  Eigen::Map<FloatMatrix>(values.data(), matrix.rows(), matrix.cols()) = matrix.template cast<float>();
  dataset.values = std::move(values);
  return dataset;
}

inline HdfTree::Dataset text_of(std::string text) {
  HdfTree::Dataset dataset;
  dataset.values = std::move(text);
  return dataset;
}

inline Error shrink(const std::string& what) {
  return {"", what + "; export the model again"};
}

/// A dataset of floats as a matrix. Errors: absent, or not of this size (−1: any).
Result<FloatMatrix> matrix_at(const HdfTree& tree, const std::string& path, Eigen::Index rows, Eigen::Index columns);

}  // namespace homolog::statismo
