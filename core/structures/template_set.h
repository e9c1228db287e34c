#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/text/side_of_name.h"
#include "core/case/relations.h"
#include "core/mesh/topology.h"
#include "core/placement/relative_pose.h"

namespace homolog {

/// One structure of a template set.
struct TemplateOfSet {
  std::string name;                                   ///< as its label map calls it; no two of a set are equal
  int value = 0;                                      ///< its label in maps that give no names
  std::size_t layer = 0;                              ///< its layer in a map in which structures overlap
  std::optional<std::array<std::uint8_t, 3>> colour;  ///< none: not known
  std::filesystem::path file;                         ///< its template; absolute in memory, relative on disk
  Side side = Side::none;
  std::string partner;                  ///< the same structure of the other side; empty: none
  std::vector<std::string> neighbours;  ///< those that touch it or nearly do, the nearest first
  std::optional<RelativePose> pose;     ///< how its place varies; none: no neighbour says where it is
  nlohmann::ordered_json other = nlohmann::ordered_json::object();  ///< fields that are not known here, kept
};

/// Vertices that two structures have in common, as bones do where they meet.
struct SharedVertices {
  std::string a, b;                  ///< the structures' names
  std::vector<VertexPair> vertices;  ///< pairs of a vertex of a's template and one of b's
};

/// The templates of several structures that belong together, `*.set.json`. They lie as in the subject that they were
/// made of (LPS mm), so that the set says where each lies to the others.
struct TemplateSet {
  std::vector<TemplateOfSet> structures;
  std::vector<SharedVertices> shared;
  nlohmann::ordered_json other = nlohmann::ordered_json::object();

  /// By its name, in any case. Null: there is none.
  const TemplateOfSet* find(const std::string& name) const;
};

/// Whether a file is named as a template set.
bool is_template_set(const std::filesystem::path& file);

/// The name of a structure's files: its own, but '_' for what no file can be called.
std::string file_name_of_structure(const std::string& name);

/// A pose as a set and a report have it. The spread of one subject is left out.
nlohmann::ordered_json json_of_pose(const RelativePose& pose);

/// Errors: absent, not JSON, no set, a newer version, a structure without a name or template, two of one name.
Result<TemplateSet> read_template_set(const std::filesystem::path& path);
/// Whole or not at all; paths of templates relative to its folder. `record`: of how it is made [file_record.h]; empty:
/// that is not known.
Result<void> write_template_set(const TemplateSet& set, const std::filesystem::path& path,
                                const std::string& record = {});

/// Fills in sides and partners from the names, where they are not known.
void find_partners(TemplateSet& set);
/// Gives a structure another name, by which its neighbours and its partner know it too. A name that says a side gives
/// it that side and its partner there. Errors, without the set's file: no such structure; no name; another has it.
Result<void> rename_structure(TemplateSet& set, const std::string& name, const std::string& new_name);
/// The names of a set for a sentence: the first of them, and how many more there are.
std::string names_in_set(const TemplateSet& set);
/// Fills in neighbours: the structures whose surface comes nearer than `near_mm`. `meshes`: one each, LPS mm.
void find_neighbours(TemplateSet& set, const std::vector<Mesh>& meshes, double near_mm);

}  // namespace homolog
