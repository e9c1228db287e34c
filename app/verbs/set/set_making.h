#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/verbs/record.h"
#include "app/verbs/verb.h"
#include "core/mesh/mesh_io.h"
#include "core/structures/maps/structures_in_map.h"

namespace homolog {

// What the verbs share that make templates of several structures: which are asked for (set_asked.cpp), their making
// (set_making.cpp, set_consensus.cpp), the files of the set (set_files.cpp).

/// The job that `set make` and `set add` are asked for.
struct SetJob {
  std::vector<std::filesystem::path> maps;
  std::filesystem::path like, out;
  std::string labels;
  bool all = false, consensus = false;
  int vertices = 2500;
  bool in_place = false;  ///< a set is changed, which then is no input any more that could be found
  GivenCommand command;

  /// The folder that templates go to: NAME beside NAME.set.json.
  std::filesystem::path folder() const;
};

/// Adds the options that say which structures are meant and how fine their templates are.
void add_structure_options(CLI::App& verb, SetJob& job);
/// Refuses a name that is none of a set.
CLI::Option* is_name_of_set(CLI::Option* output);

/// A set while it is made. All but `rows` are in the order of its structures.
struct SetInMaking {
  SetOfTemplates made;
  std::vector<MeshFile> files;                    ///< without faces: the template lies on the disk already
  std::vector<std::vector<Similarity>> relative;  ///< for each subject, from where neighbours say to where it is
  std::vector<Json> rows;                         ///< rows of the report, also of those without a template
  int highest_value = 0;                          ///< the highest label of the maps that are asked for
  std::vector<std::string> warnings;
};

/// The structures that are asked for, of each map those that it has. If all of a map are asked for, those are left
/// out whose name two labels have, with a warning. Errors: a map that cannot be read, or is given twice; a label that
/// no map has; two structures of one name that were asked for.
Result<std::vector<std::vector<Segment>>> structures_asked(const SetJob& job, SetInMaking& making, Progress& progress);

/// Errors: a file is there under the name of a template that is to be made, and the set that is written over has it
/// not; but for those of the same command that was stopped. `known`: what has its template already.
Result<void> check_templates_free(const SetJob& job, const std::vector<std::vector<Segment>>& asked,
                                  const TemplateSet& known, Progress& progress);

/// The name of a segment in the set.
std::string name_in_set(const Segment& segment);

/// Where a structure's template is written, from the root.
std::filesystem::path file_of_template(const SetJob& job, const std::string& structure);

/// A template that is not in the set yet, and what the report says of it.
struct MadeStructure {
  TemplateOfSet structure;
  MeshFile file;  ///< without faces: no template could be made
  Json row;
  std::vector<std::string> warnings;

  bool is_there() const { return file.triangles.rows() > 0; }
};
MadeStructure without_template(const Segment& segment);
/// Gives it its template, or says why it has none.
void take_template(Result<MeshFile> file, const SetJob& job, MadeStructure& made);
/// Puts a structure at the end of the set: where another has its value, it gets one that no label has. One without
/// template is in the report alone, where the next map's takes its place.
void append(MadeStructure made, SetInMaking& making);

/// Adds templates of a map's structures that the set lacks, and how the others lie in it. They are placed by their
/// neighbours, those of the first map as they are. Errors: the map; cancelled.
Result<void> add_map(const SetJob& job, const std::filesystem::path& map, const std::vector<Segment>& asked,
                     SetInMaking& making, Progress& progress);

/// Adds consensus templates of the structures of several maps, each in its mean place. Errors: a map; cancelled.
Result<void> add_consensus(const SetJob& job, const std::vector<std::vector<Segment>>& asked, SetInMaking& making,
                           Progress& progress);

/// Writes the templates that are new, and then the set, with partners and neighbours. A warning names the templates in
/// the set's folder that only the old set of this name had. Errors: the disk; no template at all; a template would
/// be written over a file that is none of the old set.
Result<Report> write_set(const SetJob& job, SetInMaking& making, Progress& progress);

/// `set make`.
Result<Report> make_set(const SetJob& job, Progress& progress);

}  // namespace homolog
