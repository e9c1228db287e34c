#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/measure/recipe/recipe.h"
#include "core/phantom/phantom.h"
#include "core/template/template.h"
#include "core/volume/volume_io.h"

namespace homolog {

// A source names an image or a template in a case file, in a study or on the command line. It is the path of a file, or
// the name of something that Homolog makes itself. Only this file knows how such names are spelled.

/// "built-in:kidney": the built-in template of an organ.
std::string built_in_source(Organ organ);
/// "phantom:kidney:1": the image of a phantom.
std::string phantom_source(Organ organ, int subject);

/// "built-in:spine": the built-in template set [core/structures/built_in_set.h]; "built-in:spine:vertebrae_L3": the
/// template of one of its structures, which lies where the set has it.
std::string built_in_set_source(const std::string& structure = {});

bool is_built_in(const std::string& source);
bool is_phantom(const std::string& source);
/// Whether a source is the path of a file: neither empty nor one of the names above.
bool names_file(const std::string& source);
/// A source as a file in `folder` names it: a path relative to the folder; what is no file by its name. And back.
std::string relative_source(const std::filesystem::path& folder, const std::string& source);
std::string resolved_source(const std::filesystem::path& folder, const std::string& name);
/// The organ that a built-in template is of. Errors: another source, no such organ.
Result<Organ> built_in_organ(const std::string& source);
/// The sources that a template may have, for help texts.
std::string template_sources();

/// The mesh of a file or of a built-in template. Errors: those of read_mesh_file; no such built-in template.
Result<MeshFile> load_mesh(const std::string& source);
/// Reads a template file, or makes a built-in template.
Result<std::shared_ptr<const Template>> load_template(const std::string& source);

/// The recipes that ship: "femur", "vertebra", "ventricle".
std::vector<std::string> shipped_recipes();
/// A recipe that ships, or that of a file [parse_recipe]. Errors: those of read_recipe; a word that is neither, with
/// the nearest.
Result<Recipe> load_recipe(const std::string& source);
/// The recipe that is kept with a template: NAME.recipe.json beside NAME.ply; of a built-in template the one of its
/// name. Empty: there is none.
std::string recipe_of_template(const std::string& template_source);

/// Reads a volume (see read_volume), or makes a phantom's image.
Result<VolumeRead> load_volume(const std::string& source, const VolumeReadOptions& options = {});

}  // namespace homolog
