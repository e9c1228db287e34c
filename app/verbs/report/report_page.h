#pragma once

#include <string>

#include "app/verbs/report/report_content.h"

namespace homolog {

/// The page as one HTML file that loads nothing: text and tables, the script that draws, and the data that it draws
/// (JSON; arrays as base64 of float32, little-endian, mm in LPS). `picture_png`: the bytes of the modes' picture for
/// browsers without WebGL and for paper; empty: none. The same content gives the same bytes.
std::string report_page(const PageContent& content, const std::string& picture_png);

}  // namespace homolog
