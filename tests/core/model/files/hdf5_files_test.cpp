#include <doctest/doctest.h>
#include <hdf5.h>

#include <fstream>
#include <functional>

#include "core/base/files/files.h"
#include "core/model/files/hdf5_reader.h"
#include "core/model/files/hdf_tree.h"
#include "core/model/files/statismo.h"
#include "tests/refusal.h"
#include "tests/shapes.h"
#include "tests/temporary_folder.h"

// HDF5 files as no model's writer makes them, by libhdf5 itself.

namespace fs = std::filesystem;
using namespace homolog;

namespace {

ShapeModel a_model() {
  const Mesh ball = icosphere(1, 20);
  ShapeMatrix shapes(ball.points.size(), 4);
  for (Eigen::Index k = 0; k < shapes.cols(); ++k)
    for (Eigen::Index i = 0; i < shapes.rows(); ++i)
      shapes(i, k) = ball.points.data()[i] + std::sin(static_cast<double>(i * (k + 2)));
  return make_model(principal_components(shapes), 0.9, ball.topology, {"a", "b", "c", "d"});
}

/// A model's file after `change`, which is given it open.
fs::path changed_model(const TemporaryFolder& folder, const std::function<void(hid_t)>& change) {
  const fs::path path = folder.path / "m.h5";
  REQUIRE(write_model(a_model(), path));
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  REQUIRE(file >= 0);
  change(file);
  REQUIRE(H5Fclose(file) >= 0);
  return path;
}

/// A dataset of floats, in place of one that is there; `values` may be null.
void put_floats(hid_t file, const char* path, hsize_t count, hid_t properties, const float* values) {
  H5Ldelete(file, path, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t made = H5Dcreate2(file, path, H5T_IEEE_F32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  REQUIRE(made >= 0);
  if (values != nullptr) REQUIRE(H5Dwrite(made, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  H5Dclose(made);
  H5Sclose(space);
}

hid_t chunked(hsize_t chunk, bool packed) {
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, 1, &chunk);
  if (packed) H5Pset_deflate(properties, 9);
  return properties;
}

}  // namespace

TEST_CASE("a model has a second of the processor and one more for each megabyte") {
  CHECK(most_reading_seconds(0) == 1);  // a model of 20 kB takes 0.02 s
  CHECK(most_reading_seconds(std::uintmax_t{100} << 20) == 101);
  CHECK(most_reading_seconds(~std::uintmax_t{0}) < 4000);
}

TEST_CASE("a model in chunks and packed is read as one that is not") {
  const TemporaryFolder folder;
  const ShapeModel model = a_model();
  const Eigen::VectorXf mean = model.mean.cast<float>();
  for (const bool packed : {false, true}) {
    const fs::path path = changed_model(folder, [&](hid_t file) {
      put_floats(file, "/model/mean", static_cast<hsize_t>(mean.size()), chunked(50, packed), mean.data());
    });
    const auto read = read_model(path);
    REQUIRE_MESSAGE(read, read.error().sentence());
    CHECK(read->mean == mean.cast<double>());
  }
}

TEST_CASE("tables of HDF5 that are not in the file are refused") {
  const TemporaryFolder folder;
  constexpr hsize_t many = 90000000;
  const auto refused = [&](const std::function<void(hid_t)>& change) {
    CHECK(says(read_model(changed_model(folder, change)), "damaged at /model/mean"));
  };
  refused([](hid_t file) { put_floats(file, "/model/mean", many, H5P_DEFAULT, nullptr); });
  refused([](hid_t file) { put_floats(file, "/model/mean", 126, H5P_DEFAULT, nullptr); });
  refused([](hid_t file) { put_floats(file, "/model/mean", 126, chunked(50, false), nullptr); });
  const std::vector<float> values(126, 1.0F);
  refused([&](hid_t file) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(properties, (folder.path / "elsewhere.bin").c_str(), 0, 504);
    put_floats(file, "/model/mean", 126, properties, values.data());
  });
  refused([](hid_t file) {  // a thousandth of what it unfolds to
    const std::vector<float> zeros(10000000);
    put_floats(file, "/model/mean", zeros.size(), chunked(1000000, true), zeros.data());
  });
}

TEST_CASE("texts of HDF5 that are longer than the file are refused") {
  const TemporaryFolder folder;
  const auto of_3_gb = [](hid_t file, const char* path) {
    const hid_t text = H5Tcopy(H5T_C_S1), scalar = H5Screate(H5S_SCALAR);
    H5Tset_size(text, std::size_t{3} << 30);
    H5Ldelete(file, path, H5P_DEFAULT);
    H5Dclose(H5Dcreate2(file, path, text, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  };
  const std::string name = "/modelinfo/modelBuilder-0/dataInfo/URI_1";
  CHECK(
      says(read_model(changed_model(folder, [&](hid_t file) { of_3_gb(file, name.c_str()); })), "damaged at " + name));
}

TEST_CASE("groups of HDF5 that link to one another and links out of the file are not followed") {
  const TemporaryFolder folder;
  const fs::path path = changed_model(folder, [](hid_t file) {
    std::string group = "/";
    for (int k = 0; k < 30; ++k) {
      const std::string inner = group + "x/";
      H5Gclose(H5Gcreate2(file, inner.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      H5Lcreate_hard(file, inner.c_str(), file, (group + "y").c_str(), H5P_DEFAULT, H5P_DEFAULT);
      group = inner;
    }
    H5Lcreate_hard(file, "/", file, "/model/root", H5P_DEFAULT, H5P_DEFAULT);
  });
  REQUIRE(read_model(path));
  const fs::path linked = changed_model(folder, [](hid_t file) {
    H5Ldelete(file, "/model/mean", H5P_DEFAULT);
    H5Lcreate_external("other.h5", "/model/mean", file, "/model/mean", H5P_DEFAULT, H5P_DEFAULT);
  });
  CHECK(says(read_model(linked), "holds no /model/mean"));
}

TEST_CASE("one table of HDF5 under many names does not fill the memory") {
  const TemporaryFolder folder;
  const fs::path path = changed_model(folder, [](hid_t file) {
    const std::string start = "/modelinfo/modelBuilder-0/dataInfo/URI_";
    const std::string text(1 << 20, 'n');
    const hid_t type = H5Tcopy(H5T_C_S1), scalar = H5Screate(H5S_SCALAR);
    H5Tset_size(type, text.size());
    H5Ldelete(file, (start + "0").c_str(), H5P_DEFAULT);
    const hid_t made = H5Dcreate2(file, (start + "0").c_str(), type, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data());
    H5Dclose(made);
    for (int k = 4; k < 1000; ++k)
      H5Lcreate_hard(file, (start + "0").c_str(), file, (start + std::to_string(k)).c_str(), H5P_DEFAULT, H5P_DEFAULT);
  });
  CHECK(says(read_model(path), "damaged at /modelinfo"));
}
