#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace homolog {

// The record of a file: how it was made, as JSON in one line of ASCII [app/verbs/record.h]. Here is how formats hold
// it: who writes a format takes its form from here, and `read_record` finds all of them. An empty record is none.

/// The name of a record in every format, and how the name of the file ends that holds it where the format cannot.
inline constexpr std::string_view record_key = "homolog.record";
inline constexpr const char* record_extension = ".made.json";

/// Lines of a text header, each `begin`, the key and a piece of the record. Pieces are short, since some readers of PLY
/// take no more than 1,024 bytes in a line.
std::string record_lines(std::string_view begin, std::string_view record);
/// Whether such a line, without its `begin`, holds a piece of a record.
bool is_record_line(std::string_view line);
/// A line KEY:=VALUE of an NRRD header with the line break before it.
std::string record_of_nrrd(std::string_view record);
/// A field of a legacy VTK file, to stand before its points.
std::string record_of_vtk(std::string_view record);
/// An array of VTP's FieldData.
std::string record_of_vtp(std::string_view record);

/// The bytes of a picture (.png, .svg), a page (.html) or JSON with a record, in place of one that they have. Without a
/// record: as they are. Errors: they are none of their format.
Result<std::string> with_record(const std::filesystem::path& path, std::string bytes, std::string_view record);

/// Puts a record into a file that was written whole: one of these formats holds it, any other has it beside. Errors:
/// the file is none of its format, the system refuses.
Result<void> add_record(const std::filesystem::path& path, std::string_view record);

/// The content of such a file before its record: `bytes` without the record, where it holds one in itself.
std::string without_record(const std::filesystem::path& path, std::string bytes);

/// Whether a file is one that holds the record of another.
bool is_record_file(const std::filesystem::path& path);
/// "a.nii.gz.made.json" of "a.nii.gz".
std::filesystem::path record_file_of(const std::filesystem::path& path);
/// Writes that file. Without a record one that is there is removed: it would be of a file that was replaced. Errors:
/// the system refuses.
Result<void> write_record_file(const std::filesystem::path& path, std::string_view record);

/// The record of a mesh, an image or a case (whose first line has it), in it or beside it; none where it has none.
/// Models have theirs in their tree [read_model_record]. Errors: the file cannot be read.
Result<std::optional<std::string>> read_record(const std::filesystem::path& path);

}  // namespace homolog
