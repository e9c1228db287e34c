#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/verbs/verb.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"

namespace homolog {

// The record that a verb's files carry: how they were made. It is JSON: the version, the command, its options without
// those that change no byte, and each input by its base name, its size and its SHA-256. No path, no date, no user.
// `verify` reads it. How formats hold it is in core/base/files/file_record.h.
//
//   {"version":"0.1.0","command":"fit","options":{"TEMPLATE":[INPUT],"--mask":[INPUT],"--label":["2"]}}
//
// INPUT is {"file":NAME,"bytes":N,"sha256":DIGITS}, with "names":[INPUT or null…] where the file names others (a case
// its image), or {"0":INPUT…} where only some of them count; or {"folder":NAME,"files":[INPUT…]}. A flag is true.
// "output":"CASE/STRUCTURE.ply" says which file of a folder it is; without it the command makes this file alone. With
// "beside":".set.json" the command writes a file *.set.json, and "output":"*/liver.ply" is named from where that lies;
// stars stand for the name that it was given.

/// A verb whose files carry records.
struct RecordedVerb {
  std::string_view name;
  std::vector<std::string_view> inputs;  ///< options that name what is read, as CLI11 calls them
  std::string_view output;               ///< the option that names the file, or the folder, to write
  std::vector<std::string_view> beside;  ///< options that name files written beside it; not in the record

  bool reads(std::string_view option) const;
  bool writes(std::string_view option) const;
};
/// Null where the files of a verb carry none.
const RecordedVerb* recorded_verb(std::string_view name);

/// An option as it was given. No values: a flag.
struct GivenOption {
  std::string name;
  std::vector<std::string> values;
};

/// A command without its outputs and what changes no byte (--jobs, --json, --quiet).
struct GivenCommand {
  std::string verb;
  std::vector<GivenOption> options;  ///< in the order in which the verb declares them

  /// The same command with other values of an option that was given; without values the option is left out.
  GivenCommand with(std::string_view option, const std::vector<std::filesystem::path>& values) const;
};

/// The command that was parsed. A recipe that lies beside --template is read as well: it stands where it would had it
/// been given by --recipe.
GivenCommand given_command(const CLI::App& verb);

/// The record of the file that the command makes, in one line of ASCII. Reads the inputs. Errors: a verb that
/// `recorded_verb` does not know; an input that cannot be read; cancelled.
Result<std::string> record_of(const GivenCommand& command, Progress& progress);

/// The same record for one file, `output`, of the folder that the command makes.
std::string record_of_output(const std::string& record, const std::string& output);

/// The same record for any file that the command writes: `output` itself (what the verb's option names), one of a
/// folder `output`, or one that lies beside it or is called after it.
std::string record_of_made(const std::string& record, const std::filesystem::path& output,
                           const std::filesystem::path& file);

/// The record of a mesh that playing a case gives: of an edit that was added to its file. `structure`: which of
/// them, by its name or id; empty: the first.
Result<std::string> record_of_case(const std::filesystem::path& case_file, const std::string& structure,
                                   Progress& progress);

/// Runs a verb, and puts the record of its command into the files that it made [Report::made]. Errors: the verb's,
/// record_of's, add_record's.
Result<Report> run_recorded(const VerbRun& run, const CLI::App& verb, Progress& progress);

}  // namespace homolog
