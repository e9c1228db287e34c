#include <hdf5.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "core/base/files/files.h"
#include "core/model/files/hdf5_reader.h"

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

/// A text of fixed or variable length, of a dataset or an attribute, read by `read(memory type, buffer)`. Errors:
/// longer than the whole file, unreadable.
template <class Read>
std::optional<std::string> read_text(hid_t type, std::uintmax_t file_bytes, const Read& read) {
  const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_cset(memory, H5Tget_cset(type));
  if (H5Tis_variable_str(type) > 0) {
    H5Tset_size(memory, H5T_VARIABLE);
    char* text = nullptr;
    if (read(memory, static_cast<void*>(&text)) < 0) return std::nullopt;
    if (text == nullptr) return "";
    const std::unique_ptr<char, herr_t (*)(void*)> owner(text, H5free_memory);
    return text;
  }
  const std::size_t size = H5Tget_size(type);
  if (size > file_bytes) return std::nullopt;
  H5Tset_size(memory, size + 1);
  std::string text(size + 1, '\0');
  if (read(memory, static_cast<void*>(text.data())) < 0) return std::nullopt;
  return text.c_str();  // up to the first zero
}

std::vector<std::size_t> dims_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> extents(static_cast<std::size_t>(std::max(0, rank)));
  if (rank > 0) H5Sget_simple_extent_dims(space, extents.data(), nullptr);
  return {extents.begin(), extents.end()};
}

/// Whether what a dataset says it holds is in the file, all of it: not left out (it would read as zeros), and not in
/// other files.
bool is_stored(hid_t dataset, hid_t space, const std::vector<std::size_t>& dims, std::uintmax_t bytes) {
  const Handle list(H5Dget_create_plist(dataset), H5Pclose);
  if (H5Pget_external_count(list) != 0) return false;
  const hsize_t stored = H5Dget_storage_size(dataset);
  const H5D_layout_t layout = H5Pget_layout(list);
  if (layout == H5D_COMPACT || layout == H5D_CONTIGUOUS) return stored >= bytes;
  std::vector<hsize_t> chunk(dims.size());
  if (layout != H5D_CHUNKED || H5Pget_chunk(list, static_cast<int>(dims.size()), chunk.data()) < 0) return false;
  hsize_t chunks = 0;
  std::uintmax_t needed = 1;
  for (std::size_t k = 0; k < dims.size(); ++k) needed *= (dims[k] + chunk[k] - 1) / chunk[k];
  return H5Dget_num_chunks(dataset, space, &chunks) >= 0 && chunks == needed;
}

/// Reads the parts that are asked for, each along its own path of hard links.
class HdfPartsReader {
 public:
  HdfPartsReader(hid_t file, std::uintmax_t file_bytes)
      : file_(file), file_bytes_(file_bytes), left_(most_value_bytes(file_bytes)) {}

  Result<HdfTree> read(const HdfParts& parts) {
    const auto done = read_parts(
        parts, [this](const std::string& group, const std::string& name) { return read_attribute(group, name); },
        [this](const std::string& path) { return read_dataset(path); });
    if (!done) return fail(done.error());
    return std::move(tree_);
  }

 private:
  static Error damaged(const std::string& path) {
    return {"", "is damaged at " + path + "; copy or export the model again"};
  }

  /// The object at the end of a path; a bad handle where there is none.
  Handle object_at(const std::string& path) const {
    hid_t at = H5Oopen(file_, "/", H5P_DEFAULT);
    for (std::size_t begin = 1; begin < path.size() && at >= 0;) {
      const std::size_t end = std::min(path.find('/', begin), path.size());
      const std::string name = path.substr(begin, end - begin);
      const Handle group(at, H5Oclose);
      H5L_info_t link;
      const bool is_there = H5Iget_type(group) == H5I_GROUP && H5Lexists(group, name.c_str(), H5P_DEFAULT) > 0 &&
                            H5Lget_info(group, name.c_str(), &link, H5P_DEFAULT) >= 0 && link.type == H5L_TYPE_HARD;
      at = is_there ? H5Oopen(group, name.c_str(), H5P_DEFAULT) : H5I_INVALID_HID;
      begin = end + 1;
    }
    return {at, H5Oclose};
  }

  bool take(std::uintmax_t bytes) {
    if (bytes > left_) return false;
    left_ -= bytes;
    return true;
  }

  Result<void> read_attribute(const std::string& path, const std::string& name) {
    const Handle group = object_at(path);
    if (!group.good() || H5Iget_type(group) != H5I_GROUP) return {};
    auto& attributes = tree_.add_group(path);
    if (H5Aexists(group, name.c_str()) <= 0) return {};
    const Handle attribute(H5Aopen(group, name.c_str(), H5P_DEFAULT), H5Aclose);
    if (!attribute.good()) return fail(damaged(path));
    const Handle type(H5Aget_type(attribute), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
    if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return {};
    const auto text =
        read_text(type, file_bytes_, [&](hid_t memory, void* buffer) { return H5Aread(attribute, memory, buffer); });
    if (!text || !take(text->size())) return fail(damaged(path));
    attributes[name] = *text;
    return {};
  }

  /// False where there is none. A dataset of another kind than a model's is left out.
  Result<bool> read_dataset(const std::string& path) {
    const Handle dataset = object_at(path);
    if (!dataset.good() || H5Iget_type(dataset) != H5I_DATASET) return false;
    const Handle type(H5Dget_type(dataset), H5Tclose), space(H5Dget_space(dataset), H5Sclose);
    HdfTree::Dataset read;
    read.dims = dims_of(space);
    const hssize_t points = H5Sget_simple_extent_npoints(space);
    const H5T_class_t kind = H5Tget_class(type);
    if (kind != H5T_FLOAT && kind != H5T_INTEGER && !(kind == H5T_STRING && points == 1)) return true;
    const std::size_t size = H5Tget_size(type);
    if (points < 0 || size == 0 || static_cast<std::uintmax_t>(points) > left_ / std::max<std::size_t>(size, 4) ||
        !is_stored(dataset, space, read.dims, static_cast<std::uintmax_t>(points) * size) ||
        !read_values(dataset, type, kind, static_cast<std::size_t>(points), read))
      return fail(damaged(path));
    tree_.add_group(path.substr(0, std::max<std::size_t>(path.rfind('/'), 1)));
    tree_.datasets[path] = std::move(read);
    return true;
  }

  bool read_values(hid_t dataset, hid_t type, H5T_class_t kind, std::size_t count, HdfTree::Dataset& into) {
    if (kind == H5T_STRING) {
      auto text = read_text(type, file_bytes_, [&](hid_t memory, void* buffer) {
        return H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
      });
      if (!text || !take(text->size())) return false;
      into.values = std::move(*text);
      return true;
    }
    if (!take(4 * count)) return false;
    if (kind == H5T_FLOAT)
      return H5Dread(dataset, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                     into.values.emplace<std::vector<float>>(count).data()) >= 0;
    return H5Dread(dataset, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                   into.values.emplace<std::vector<std::int32_t>>(count).data()) >= 0;
  }

  hid_t file_;
  std::uintmax_t file_bytes_, left_;
  HdfTree tree_;
};

Handle text_type() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return {type, H5Tclose};
}

/// Properties of a new object that keeps no time, so that the same model gives the same bytes.
Handle without_time(hid_t of_objects) {
  const hid_t properties = H5Pcreate(of_objects);
  H5Pset_obj_track_times(properties, false);
  return {properties, H5Pclose};
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
    const Handle properties = without_time(H5P_DATASET_CREATE);
    const Handle made(H5Dcreate2(file, path.c_str(), stored, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
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
  const Handle properties = without_time(H5P_GROUP_CREATE);
  for (const auto& [path, attributes] : tree.groups) {  // parents come first in this order
    const Handle group(path == "/" ? H5Gopen2(file, "/", H5P_DEFAULT)
                                   : H5Gcreate2(file, path.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT),
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

Result<HdfTree> read_hdf5_unconfined(const fs::path& path, const HdfParts& parts) {
  be_quiet();
  const auto bytes = size_of_file(path);
  if (!bytes) return fail(bytes.error());
  if (H5Fis_hdf5(path.c_str()) <= 0)
    return fail(path.string(), "is no HDF5 file, or was cut off; copy or export it again");
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.good()) return fail(path.string(), "is a damaged HDF5 file; copy or export it again");
  return HdfPartsReader(file, *bytes).read(parts);
}

Result<void> write_hdf5(const HdfTree& tree, const fs::path& path) {
  be_quiet();
  // In memory: on a full disk the library cannot close its files, and crashes at the program's end.
  constexpr std::size_t grows_by = std::size_t{1} << 20;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access, grows_by, 0);
  const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  const ssize_t size = file.good() && write_tree(tree, file) ? H5Fget_file_image(file, nullptr, 0) : -1;
  std::string image(static_cast<std::size_t>(std::max<ssize_t>(size, 0)), '\0');
  if (size < 0 || H5Fget_file_image(file, image.data(), image.size()) != size)
    return fail(path.string(), "cannot be made an HDF5 file; save it as .h5.json");
  return write_whole_file(path, image);
}

}  // namespace homolog
