#pragma once

#include <doctest/doctest.h>

#include <string>

#include "core/base/result.h"

namespace homolog {

/// Whether the result is an error whose sentence contains `what`; a failed check around it prints the sentence.
template <class T>
bool says(const Result<T>& result, const std::string& what) {
  if (result) return false;
  INFO(result.error().sentence());
  return result.error().sentence().find(what) != std::string::npos;
}

}  // namespace homolog
