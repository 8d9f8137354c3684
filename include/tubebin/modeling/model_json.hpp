/// model.json: the tubes that modeling found. Its format is docs/model.schema.json.
#pragma once

#include <string>

#include "tubebin/cloud/cloud.hpp"
#include "tubebin/modeling/pipeline.hpp"

namespace tubebin::modeling {

/// JSON text of the tubes, their colours (`colors` of label 0, which is the null colour, and every tube), the figures
/// estimated from the cloud, and the options as `describe_options` lists them; `with_seconds` adds the stages' times,
/// which are all that differs from run to run.
std::string format_model_json(const ModelingResult& result, const std::vector<cloud::Color>& colors,
                              const std::function<void(Fields&)>& describe_options, bool with_seconds);

/// The options as JSON text, in the order in which they are described.
std::string format_options_json(const std::function<void(Fields&)>& describe_options);

/// times.json: `seconds` and the time to read the cloud.
std::string format_times_json(const StageSeconds& seconds, double read_seconds);

}  // namespace tubebin::modeling
