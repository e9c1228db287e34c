#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/encoding/hash.h"
#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/mesh/formats/text.h"
#include "core/model/files/hdf_tree.h"

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

std::map<std::string, std::string>& HdfTree::add_group(const std::string& path) {
  groups["/"];
  for (std::size_t slash = path.find('/', 1); slash != std::string::npos; slash = path.find('/', slash + 1))
    groups[path.substr(0, slash)];
  return groups[path];
}

namespace {

std::pair<std::string, std::string> parent_and_name(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return {slash == 0 ? "/" : path.substr(0, slash), path.substr(slash + 1)};
}

// ---- reading

/// A number that fits, as files may hold any.
template <class Number>
bool take_number(const nlohmann::json& value, std::vector<Number>& into) {
  using Limits = std::numeric_limits<Number>;
  if (!value.is_number()) return false;
  const auto number = value.get<double>();
  if (!(number >= Limits::lowest() && number <= Limits::max()) || (Limits::is_integer && number != std::trunc(number)))
    return false;
  into.push_back(static_cast<Number>(number));
  return true;
}

/// Appends the numbers of nested arrays, checking that they are `dims` deep and wide.
template <class Number>
bool flatten(const nlohmann::json& value, const std::vector<std::size_t>& dims, std::size_t level,
             std::vector<Number>& into) {
  if (level == dims.size()) return take_number(value, into);
  if (!value.is_array() || value.size() != dims[level]) return false;
  for (const nlohmann::json& entry : value)
    if (!flatten(entry, dims, level + 1, into)) return false;
  return true;
}

/// Reads the parts that are asked for, each along its own path of links.
class JsonPartsReader {
 public:
  JsonPartsReader(const nlohmann::json& file, std::uintmax_t file_bytes)
      : file_(file), left_(most_value_bytes(file_bytes)) {}

  Result<HdfTree> read(const HdfParts& parts) {
    if (!file_.contains("groups") || file_.value("root", "").empty())
      return fail("", "is JSON but no HDF5-JSON; export the model again");
    const auto done = read_parts(
        parts,
        [this](const std::string& group, const std::string& name) {
          read_attribute(group, name);
          return Result<void>();
        },
        [this](const std::string& path) { return read_dataset(path); });
    if (!done) return fail(done.error());
    return std::move(tree_);
  }

 private:
  /// The object that a link leads to.
  struct Target {
    std::string collection, id;
  };

  /// The object of a collection ("groups", "datasets") under an identifier; null where it holds none.
  const nlohmann::json& object(const Target& target) const {
    static const nlohmann::json none;
    const auto found = file_.find(target.collection);
    if (found == file_.end() || !found->is_object()) return none;
    const auto entry = found->find(target.id);
    return entry != found->end() && entry->is_object() ? *entry : none;
  }

  /// The hard links of a group by their titles, gone through once: a group may hold thousands.
  const std::map<std::string, Target>& links_of(const Target& group) {
    const auto [at, added] = links_.try_emplace(group.id);
    const nlohmann::json& read = object(group);
    if (!added || !read.contains("links")) return at->second;
    for (const nlohmann::json& link : read["links"])
      if (link.is_object() && link.value("class", "") == "H5L_TYPE_HARD")
        at->second.try_emplace(link.value("title", ""), Target{link.value("collection", ""), link.value("id", "")});
    return at->second;
  }

  /// Follows a path from the root; nothing where it does not lead to a member of `collection`.
  std::optional<Target> target_at(const std::string& path, const std::string& collection) {
    Target at{"groups", file_.value("root", "")};
    for (std::size_t begin = 1; begin < path.size();) {
      if (at.collection != "groups") return std::nullopt;
      const std::size_t end = std::min(path.find('/', begin), path.size());
      const auto& links = links_of(at);
      const auto found = links.find(path.substr(begin, end - begin));
      if (found == links.end()) return std::nullopt;
      at = found->second;
      begin = end + 1;
    }
    return at.collection == collection ? std::optional(at) : std::nullopt;
  }

  void read_attribute(const std::string& path, const std::string& name) {
    const auto target = target_at(path, "groups");
    if (!target) return;
    auto& attributes = tree_.add_group(path);
    const nlohmann::json& group = object(*target);
    if (!group.contains("attributes")) return;
    for (const nlohmann::json& attribute : group["attributes"])
      if (attribute.is_object() && attribute.value("name", "") == name && attribute.contains("value") &&
          attribute["value"].is_string())
        attributes[name] = attribute["value"].get<std::string>();
  }

  /// False where there is none. Errors: values that do not fill its shape, more values than the file has room for.
  Result<bool> read_dataset(const std::string& path) {
    const auto target = target_at(path, "datasets");
    if (!target) return false;
    const nlohmann::json& dataset = object(*target);
    HdfTree::Dataset read;
    if (!dataset.contains("value") || !take_values(dataset, read))
      return fail("", "has a dataset " + path + " whose values do not fill its shape; copy or export the model again");
    const std::uintmax_t bytes = std::visit(
        [](const auto& values) -> std::uintmax_t { return values.size() * sizeof *values.data(); }, read.values);
    if (bytes > left_) return fail("", "names one dataset by too many paths; export the model again");
    left_ -= bytes;
    tree_.add_group(parent_and_name(path).first);
    tree_.datasets[path] = std::move(read);
    return true;
  }

  static bool take_values(const nlohmann::json& dataset, HdfTree::Dataset& into) {
    const nlohmann::json& value = dataset["value"];
    const nlohmann::json shape = dataset.value("shape", nlohmann::json::object());
    if (shape.contains("dims")) into.dims = shape["dims"].get<std::vector<std::size_t>>();
    const std::string kind = dataset.value("type", nlohmann::json::object()).value("class", "");
    if (kind == "H5T_INTEGER") return flatten(value, into.dims, 0, into.values.emplace<std::vector<std::int32_t>>());
    if (kind == "H5T_FLOAT") return flatten(value, into.dims, 0, into.values.emplace<std::vector<float>>());
    if (kind != "H5T_STRING" || !value.is_string()) return false;
    into.values = value.get<std::string>();
    return true;
  }

  const nlohmann::json& file_;
  std::uintmax_t left_;
  std::map<std::string, std::map<std::string, Target>> links_;  ///< links of groups, by their identifiers
  HdfTree tree_;
};

// ---- writing

/// The identifier of the object at a path: a UUID in form, made from the path alone.
std::string identifier(const std::string& path) {
  Hash first, second{.value = 0x9ae16a3b2f90404fU};
  for (const char c : path)
    for (Hash* half : {&first, &second}) half->add(static_cast<unsigned char>(c));
  // Each half stands with its lowest digit first.
  const std::string low = first.hex(), high = second.hex();
  std::string id(low.rbegin(), low.rend());
  id.append(high.rbegin(), high.rend());
  for (const std::size_t at : {8U, 13U, 18U, 23U}) id.insert(at, 1, '-');
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

Result<HdfTree> read_hdf5_json(const std::filesystem::path& path, const HdfParts& parts) {
  auto bytes = read_whole_file(path);
  if (!bytes) return fail(bytes.error());
  const std::size_t file_bytes = bytes->size();
  const auto file = read_json<nlohmann::json>(*bytes);
  *bytes = std::string();  // may be large, and is not needed any more
  if (!file) return fail(path.string(), file.error().what + "; copy or export the model again");
  if (!file->is_object()) return fail(path.string(), "is JSON but no HDF5-JSON; export the model again");
  try {
    auto tree = JsonPartsReader(*file, file_bytes).read(parts);
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
