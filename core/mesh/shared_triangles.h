#pragma once

#include <memory>
#include <utility>

#include "core/mesh/topology.h"

namespace homolog {

/// Triangles that several meshes may have in common: m×3, changed only as a copy. A thousand shapes in correspondence
/// have the same ones, which would take as much memory as their points. Reads as Triangles.
class SharedTriangles {
 public:
  SharedTriangles() = default;
  SharedTriangles(const SharedTriangles&) = default;  // moved too: what is left behind is still a list
  SharedTriangles& operator=(const SharedTriangles&) = default;
  ~SharedTriangles() = default;
  SharedTriangles(Triangles triangles) : triangles_(std::make_shared<const Triangles>(std::move(triangles))) {}
  template <class Derived>
  SharedTriangles(const Eigen::DenseBase<Derived>& triangles) : SharedTriangles(Triangles(triangles)) {}
  /// Those of a topology, without a copy; it stays as long as they do. None where it is null.
  SharedTriangles(const std::shared_ptr<const Topology>& of)
      : triangles_(of ? std::shared_ptr<const Triangles>(of, &of->triangles()) : none()) {}

  operator const Triangles&() const { return *triangles_; }
  const Triangles& operator*() const { return *triangles_; }
  const Triangles* operator->() const { return triangles_.get(); }
  Eigen::Index rows() const { return triangles_->rows(); }
  Eigen::Index size() const { return triangles_->size(); }
  auto row(Eigen::Index t) const { return triangles_->row(t); }
  std::int32_t operator()(Eigen::Index t, Eigen::Index corner) const { return (*triangles_)(t, corner); }
  /// A copy of its own, to be changed.
  Triangles& edit() {
    auto own = std::make_shared<Triangles>(*triangles_);
    triangles_ = own;
    return *own;
  }
  bool operator==(const SharedTriangles& other) const { return *this == *other; }
  bool operator==(const Triangles& other) const {
    return triangles_.get() == &other || (rows() == other.rows() && *triangles_ == other);
  }

 private:
  static const std::shared_ptr<const Triangles>& none() {
    static const auto empty = std::make_shared<const Triangles>(0, 3);
    return empty;
  }
  std::shared_ptr<const Triangles> triangles_ = none();
};

}  // namespace homolog
