#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/files.h"
#include "core/mesh/formats/text.h"
#include "core/model/hdf_tree.h"

namespace homolog {

const std::vector<float>* HdfTree::floats(const std::string& path) const {
  const auto found = datasets.find(path);
  return found != datasets.end() ? std::get_if<std::vector<float>>(&found->second.values) : nullptr;
}

const std::vector<std::int32_t>* HdfTree::integers(const std::string& path) const {
  const auto found = datasets.find(path);
  return found != datasets.end() ? std::get_if<std::vector<std::int32_t>>(&found->second.values) : nullptr;
}

std::string HdfTree::text(const std::string& path) const {
  const auto found = datasets.find(path);
  const auto* text = found != datasets.end() ? std::get_if<std::string>(&found->second.values) : nullptr;
  return text != nullptr ? *text : "";
}

std::string HdfTree::attribute(const std::string& group, const std::string& name) const {
  const auto found = groups.find(group);
  if (found == groups.end()) return "";
  const auto value = found->second.find(name);
  return value != found->second.end() ? value->second : "";
}

namespace {

constexpr int deepest_group = 32;

std::string below(const std::string& group, const std::string& name) {
  return group == "/" ? "/" + name : group + "/" + name;
}

std::pair<std::string, std::string> parent_and_name(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return {slash == 0 ? "/" : path.substr(0, slash), path.substr(slash + 1)};
}

// ---- reading

/// Appends the numbers of nested arrays, checking that they are `dims` deep and wide.
template <class Number>
bool flatten(const nlohmann::json& value, const std::vector<std::size_t>& dims, std::size_t level,
             std::vector<Number>& into) {
  if (level == dims.size()) {
    if (!value.is_number()) return false;
    into.push_back(value.get<Number>());
    return true;
  }
  if (!value.is_array() || value.size() != dims[level]) return false;
  for (const nlohmann::json& entry : value)
    if (!flatten(entry, dims, level + 1, into)) return false;
  return true;
}

class JsonTreeReader {
 public:
  explicit JsonTreeReader(const nlohmann::json& file) : file_(file) {}

  Result<HdfTree> read() {
    const auto root = file_.value("root", "");
    if (!file_.contains("groups") || root.empty()) return fail("", "is JSON but no HDF5-JSON; export the model again");
    if (auto done = read_group(root, "/", 0); !done) return fail(done.error());
    return std::move(tree_);
  }

 private:
  /// What collection ("groups", "datasets") holds under an identifier; null where it does not.
  const nlohmann::json& object(const char* collection, const std::string& id) const {
    static const nlohmann::json none;
    const auto found = file_.find(collection);
    if (found == file_.end() || !found->is_object()) return none;
    const auto entry = found->find(id);
    return entry != found->end() && entry->is_object() ? *entry : none;
  }

  Result<void> read_group(const std::string& id, const std::string& path, int depth) {
    const nlohmann::json& group = object("groups", id);
    if (group.is_null() || depth > deepest_group)
      return fail("", "has no group for " + path + "; copy or export the model again");
    auto& attributes = tree_.groups[path];
    if (group.contains("attributes"))
      for (const nlohmann::json& attribute : group["attributes"])
        if (attribute.is_object() && attribute.contains("value") && attribute["value"].is_string())
          attributes[attribute.value("name", "")] = attribute["value"].get<std::string>();
    if (!group.contains("links")) return {};
    for (const nlohmann::json& link : group["links"]) {
      if (!link.is_object() || link.value("class", "") != "H5L_TYPE_HARD") continue;
      const std::string inner = below(path, link.value("title", "")), target = link.value("id", "");
      const std::string collection = link.value("collection", "");
      auto done = collection == "groups"     ? read_group(target, inner, depth + 1)
                  : collection == "datasets" ? read_dataset(target, inner)
                                             : Result<void>();
      if (!done) return done;
    }
    return {};
  }

  Result<void> read_dataset(const std::string& id, const std::string& path) {
    const nlohmann::json& dataset = object("datasets", id);
    const Error damaged{
        "", "has a dataset " + path + " whose values do not fill its shape; copy or export the model again"};
    if (!dataset.contains("value")) return fail(damaged);
    HdfTree::Dataset read;
    const nlohmann::json shape = dataset.value("shape", nlohmann::json::object());
    if (shape.contains("dims")) read.dims = shape["dims"].get<std::vector<std::size_t>>();
    const std::string kind = dataset.value("type", nlohmann::json::object()).value("class", "");
    const nlohmann::json& value = dataset["value"];
    bool filled = false;
    if (kind == "H5T_STRING") {
      filled = value.is_string();
      if (filled) read.values = value.get<std::string>();
    } else if (kind == "H5T_INTEGER") {
      filled = flatten(value, read.dims, 0, read.values.emplace<std::vector<std::int32_t>>());
    } else if (kind == "H5T_FLOAT") {
      filled = flatten(value, read.dims, 0, read.values.emplace<std::vector<float>>());
    }
    if (!filled) return fail(damaged);
    tree_.datasets[path] = std::move(read);
    return {};
  }

  const nlohmann::json& file_;
  HdfTree tree_;
};

// ---- writing

/// The identifier of the object at a path: a UUID in form, made from the path alone.
std::string identifier(const std::string& path) {
  std::uint64_t halves[2] = {0xcbf29ce484222325U, 0x9ae16a3b2f90404fU};
  for (const char c : path)
    for (std::uint64_t& half : halves) half = (half ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  constexpr char digits[] = "0123456789abcdef";
  std::string id;
  for (int k = 0; k < 32; ++k) {
    if (k == 8 || k == 12 || k == 16 || k == 20) id += '-';
    id += digits[(halves[k / 16] >> (4 * (k % 16))) & 15U];
  }
  return id;
}

nlohmann::json type_of(const HdfTree::Dataset& dataset) {
  if (std::holds_alternative<std::vector<float>>(dataset.values))
    return {{"class", "H5T_FLOAT"}, {"base", "H5T_IEEE_F32LE"}};
  if (std::holds_alternative<std::vector<std::int32_t>>(dataset.values))
    return {{"class", "H5T_INTEGER"}, {"base", "H5T_STD_I32LE"}};
  return {
      {"class", "H5T_STRING"}, {"charSet", "H5T_CSET_UTF8"}, {"strPad", "H5T_STR_NULLPAD"}, {"length", "H5T_VARIABLE"}};
}

nlohmann::json shape_of(const HdfTree::Dataset& dataset) {
  if (dataset.dims.empty()) return {{"class", "H5S_SCALAR"}};
  return {{"class", "H5S_SIMPLE"}, {"dims", dataset.dims}};
}

/// Numbers as nested arrays, straight into text: a JSON value a number would cost ten times the memory.
template <class Number>
void append_values(const std::vector<Number>& values, const std::vector<std::size_t>& dims, std::size_t level,
                   std::size_t& next, std::string& text) {
  if (level == dims.size()) {
    formats::append_number(values[next++], text);
    return;
  }
  text += '[';
  for (std::size_t i = 0; i < dims[level]; ++i) {
    if (i > 0) text += ',';
    append_values(values, dims, level + 1, next, text);
  }
  text += ']';
}

std::string value_text(const HdfTree::Dataset& dataset) {
  if (const auto* words = std::get_if<std::string>(&dataset.values))
    return nlohmann::json(*words).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string text;
  std::size_t next = 0;
  if (const auto* numbers = std::get_if<std::vector<float>>(&dataset.values))
    append_values(*numbers, dataset.dims, 0, next, text);
  else
    append_values(std::get<std::vector<std::int32_t>>(dataset.values), dataset.dims, 0, next, text);
  return text;
}

nlohmann::json group_json(const HdfTree& tree, const std::string& path) {
  nlohmann::json attributes = nlohmann::json::array(), links = nlohmann::json::array();
  for (const auto& [name, value] : tree.groups.at(path)) {
    HdfTree::Dataset text;
    text.values = value;
    attributes.push_back({{"name", name}, {"type", type_of(text)}, {"shape", shape_of(text)}, {"value", value}});
  }
  const auto link = [&](const std::string& inner, const char* collection) {
    const auto [parent, name] = parent_and_name(inner);
    if (parent == path && !name.empty())
      links.push_back(
          {{"class", "H5L_TYPE_HARD"}, {"collection", collection}, {"id", identifier(inner)}, {"title", name}});
  };
  for (const auto& [inner, unused] : tree.groups) link(inner, "groups");
  for (const auto& [inner, unused] : tree.datasets) link(inner, "datasets");
  return {{"alias", nlohmann::json::array({path})}, {"attributes", std::move(attributes)}, {"links", std::move(links)}};
}

}  // namespace

Result<HdfTree> read_hdf5_json(const std::filesystem::path& path) {
  const auto bytes = read_whole_file(path);
  if (!bytes) return fail(bytes.error());
  const nlohmann::json file = nlohmann::json::parse(*bytes, nullptr, false);
  if (!file.is_object()) return fail(path.string(), "is not JSON, or was cut off; copy or export the model again");
  try {
    auto tree = JsonTreeReader(file).read();
    if (!tree) return fail(path.string(), tree.error().what);
    return tree;
  } catch (const nlohmann::json::exception&) {
    return fail(path.string(), "is JSON but no HDF5-JSON; export the model again");
  }
}

Result<void> write_hdf5_json(const HdfTree& tree, const std::filesystem::path& path) {
  return write_whole_file(path, [&](std::ostream& out) -> Result<void> {
    out << R"({"apiVersion":"1.0.0","root":")" << identifier("/") << R"(","groups":{)";
    const char* comma = "";
    for (const auto& [group, attributes] : tree.groups) {
      out << comma << '"' << identifier(group) << "\":" << group_json(tree, group).dump();
      comma = ",";
    }
    out << R"(},"datasets":{)";
    comma = "";
    for (const auto& [name, dataset] : tree.datasets) {
      out << comma << '"' << identifier(name) << R"(":{"alias":[)" << nlohmann::json(name).dump() << R"(],"shape":)"
          << shape_of(dataset).dump() << R"(,"type":)" << type_of(dataset).dump() << R"(,"value":)"
          << value_text(dataset) << '}';
      comma = ",";
    }
    out << "}}\n";
    return {};
  });
}

}  // namespace homolog
