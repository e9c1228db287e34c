#include <hdf5.h>

#include <memory>
#include <numeric>

#include "core/base/files.h"
#include "core/model/hdf_tree.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// Owns one of libhdf5's identifiers.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): libhdf5 takes nothing else
  bool good() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// The library prints every error it meets unless it is told not to.
void be_quiet() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

/// A text of fixed or variable length, of a dataset or an attribute, read by `read(memory type, buffer)`.
template <class Read>
std::string read_text(hid_t type, const Read& read) {
  const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_cset(memory, H5Tget_cset(type));
  if (H5Tis_variable_str(type) > 0) {
    H5Tset_size(memory, H5T_VARIABLE);
    char* text = nullptr;
    if (read(memory, static_cast<void*>(&text)) < 0 || text == nullptr) return "";
    const std::unique_ptr<char, herr_t (*)(void*)> owner(text, H5free_memory);
    return text;
  }
  const std::size_t size = H5Tget_size(type);
  H5Tset_size(memory, size + 1);
  std::string text(size + 1, '\0');
  if (read(memory, static_cast<void*>(text.data())) < 0) return "";
  return text.c_str();  // up to the first zero
}

std::vector<std::size_t> dims_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> extents(static_cast<std::size_t>(std::max(0, rank)));
  if (rank > 0) H5Sget_simple_extent_dims(space, extents.data(), nullptr);
  return {extents.begin(), extents.end()};
}

class HdfTreeReader {
 public:
  explicit HdfTreeReader(std::uintmax_t file_bytes) : file_bytes_(file_bytes) {}

  Result<void> read_group(hid_t group, const std::string& path) {
    if (path.size() > 1000) return fail("", "has groups nested too deeply; export the model again");
    read_attributes(group, path);
    H5G_info_t info;
    if (H5Gget_info(group, &info) < 0) return fail(damaged(path));
    for (hsize_t i = 0; i < info.nlinks; ++i) {
      char name[256] = {};
      if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT) < 0)
        return fail(damaged(path));
      H5L_info_t link;
      if (H5Lget_info(group, name, &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD) continue;
      const Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
      const std::string inner = path == "/" ? std::string("/") + name : path + "/" + name;
      if (!object.good()) return fail(damaged(inner));
      const H5I_type_t kind = H5Iget_type(object);
      auto done = kind == H5I_GROUP     ? read_group(object, inner)
                  : kind == H5I_DATASET ? read_dataset(object, inner)
                                        : Result<void>();
      if (!done) return done;
    }
    return {};
  }

  HdfTree tree;

 private:
  static Error damaged(const std::string& path) {
    return {"", "is damaged at " + path + "; copy or export the model again"};
  }

  void read_attributes(hid_t group, const std::string& path) {
    auto& attributes = tree.groups[path];
    H5O_info_t info;
    if (H5Oget_info2(group, &info, H5O_INFO_NUM_ATTRS) < 0) return;
    for (hsize_t i = 0; i < info.num_attrs; ++i) {
      const Handle attribute(H5Aopen_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
      if (!attribute.good()) continue;
      char name[256] = {};
      H5Aget_name(attribute, sizeof name, name);
      const Handle type(H5Aget_type(attribute), H5Tclose);
      if (H5Tget_class(type) != H5T_STRING) continue;
      attributes[name] =
          read_text(type, [&](hid_t memory, void* buffer) { return H5Aread(attribute, memory, buffer); });
    }
  }

  Result<void> read_dataset(hid_t dataset, const std::string& path) {
    const Handle type(H5Dget_type(dataset), H5Tclose), space(H5Dget_space(dataset), H5Sclose);
    HdfTree::Dataset read;
    read.dims = dims_of(space);
    const hssize_t points = H5Sget_simple_extent_npoints(space);
    // A chunk may be compressed, but hardly a thousandfold.
    if (points < 0 || static_cast<std::uintmax_t>(points) / 1000 > file_bytes_) return fail(damaged(path));
    const auto count = static_cast<std::size_t>(points);
    const H5T_class_t kind = H5Tget_class(type);
    herr_t done = 0;
    if (kind == H5T_FLOAT) {
      auto& values = read.values.emplace<std::vector<float>>(count);
      done = H5Dread(dataset, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    } else if (kind == H5T_INTEGER) {
      auto& values = read.values.emplace<std::vector<std::int32_t>>(count);
      done = H5Dread(dataset, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    } else if (kind == H5T_STRING && count == 1) {
      read.values = read_text(type, [&](hid_t memory, void* buffer) {
        return H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
      });
    } else {
      return {};  // of no use to a shape model
    }
    if (done < 0) return fail(damaged(path));
    tree.datasets[path] = std::move(read);
    return {};
  }

  std::uintmax_t file_bytes_;
};

Handle text_type() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return {type, H5Tclose};
}

bool write_attribute(hid_t group, const std::string& name, const std::string& value) {
  const Handle type = text_type(), space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(group, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const char* text = value.c_str();
  return attribute.good() && H5Awrite(attribute, type, static_cast<const void*>(&text)) >= 0;
}

bool write_dataset(hid_t file, const std::string& path, const HdfTree::Dataset& dataset) {
  const std::vector<hsize_t> extents(dataset.dims.begin(), dataset.dims.end());
  const Handle space(extents.empty() ? H5Screate(H5S_SCALAR)
                                     : H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr),
                     H5Sclose);
  const auto write = [&](hid_t stored, hid_t memory, const void* values) {
    const Handle made(H5Dcreate2(file, path.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    return made.good() && H5Dwrite(made, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
  };
  if (const auto* numbers = std::get_if<std::vector<float>>(&dataset.values))
    return write(H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, numbers->data());
  if (const auto* numbers = std::get_if<std::vector<std::int32_t>>(&dataset.values))
    return write(H5T_STD_I32LE, H5T_NATIVE_INT32, numbers->data());
  const Handle type = text_type();
  const char* text = std::get<std::string>(dataset.values).c_str();
  return write(type, type, static_cast<const void*>(&text));
}

bool write_tree(const HdfTree& tree, hid_t file) {
  for (const auto& [path, attributes] : tree.groups) {  // parents come first in this order
    const Handle group(path == "/" ? H5Gopen2(file, "/", H5P_DEFAULT)
                                   : H5Gcreate2(file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                       H5Gclose);
    if (!group.good()) return false;
    for (const auto& [name, value] : attributes)
      if (!write_attribute(group, name, value)) return false;
  }
  for (const auto& [path, dataset] : tree.datasets)
    if (!write_dataset(file, path, dataset)) return false;
  return H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0;
}

}  // namespace

Result<HdfTree> read_hdf5(const fs::path& path) {
  be_quiet();
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) {
    const bool absent = !fs::exists(path, error);
    return fail(path.string(), absent ? "does not exist; check the name" : "is no file that can be read");
  }
  if (H5Fis_hdf5(path.c_str()) <= 0)
    return fail(path.string(), "is no HDF5 file, or was cut off; copy or export it again");
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.good()) return fail(path.string(), "is a damaged HDF5 file; copy or export it again");
  const Handle root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose);
  if (!root.good()) return fail(path.string(), "is a damaged HDF5 file; copy or export it again");
  HdfTreeReader reader(bytes);
  if (auto done = reader.read_group(root, "/"); !done) return fail(path.string(), done.error().what);
  return std::move(reader.tree);
}

Result<void> write_hdf5(const HdfTree& tree, const fs::path& path) {
  be_quiet();
  return write_through_temporary(path, [&](const fs::path& temporary) -> Result<void> {
    const Handle file(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    if (!file.good() || !write_tree(tree, file))
      return fail(temporary.string(), "cannot be written; free some space or choose another folder");
    return {};
  });
}

}  // namespace homolog
