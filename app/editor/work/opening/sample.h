#pragma once

#include "app/editor/state/open_request.h"
#include "core/base/result.h"

namespace homolog {

/// Opens the sample with the built-in ventricle, from a folder of the program's own: the opener writes it there first
/// [make_sample].
OpenRequest sample_request();
/// Writes the sample where `request` asks for it; does nothing for all other requests.
Result<void> make_sample(const OpenRequest& request);

}  // namespace homolog
