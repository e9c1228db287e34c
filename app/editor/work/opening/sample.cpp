#include "app/editor/work/opening/sample.h"

#include "app/sample/sample.h"

namespace homolog {

OpenRequest sample_request() {
  const OwnSample sample = own_sample();
  OpenRequest request;
  request.volume_source = sample.image.string();
  request.labels = sample.labels;
  request.template_source = sample.template_source;
  return request;
}

Result<void> make_sample(const OpenRequest& request) {
  return request.volume_source == own_sample().image ? write_own_sample() : Result<void>();
}

}  // namespace homolog
