#include "output_schemas.h"

#include "rigproof/core/fields.h"

namespace rigproof {
namespace {

using Lines = std::vector<KeyLine>;

// Puts a path before the lines of a part.
Lines below(const std::string& path, const Lines& lines) {
  Lines all;
  for (const KeyLine& line : lines) all.push_back({path + line.path, line.type, line.description});
  return all;
}

std::string schema_of_parts(const std::string& title, const std::vector<Lines>& parts) {
  Lines all;
  for (const Lines& part : parts) all.insert(all.end(), part.begin(), part.end());
  return schema_of_keys(title, all);
}

const Lines kCheck = {{".name", "text", "what is checked, of which camera"},
                      {".code", "text", "of the finding that failed it without a value; else empty"},
                      {".passed", "boolean", "whether it holds"},
                      {".value", "number or null", "what was found; null where there is none"},
                      {".limit", "number or null", "what is allowed"},
                      {".unit", "text", "of value and limit"},
                      {".reason", "text", "why it failed without a value; else empty"}};

const Lines kTransform = {{"", "", "poses"},
                          {".parent", "text", "frame that the pose is given in"},
                          {".child", "text", "frame whose pose it is"},
                          {".translation_m?", "numbers", "x, y, z; where all six degrees of freedom are determined"},
                          {".quaternion_xyzw?", "numbers", "the same"},
                          {".unobservable?", "texts", "degrees of freedom that the data do not determine"},
                          {".sigma?", "", "one sigma of those that they do"},
                          {".sigma.NAME", "number", "tx_m ty_m tz_m rx_rad ry_rad rz_rad"}};

const Lines kError = {{"", "", "errors of poses"},
                      {".parent", "text", "frame that the pose is given in"},
                      {".child", "text", "frame whose pose it is"},
                      {".error_m_rad", "numbers", "tx ty tz rx ry rz along the parent's axes"},
                      {".sigma_m_rad", "numbers or null", "what the method states; null where it states nothing"},
                      {".z[]", "number or null", "error over sigma, axis by axis"},
                      {".observable[]", "boolean", "axis by axis"},
                      {".roll_pitch_yaw_error_rad", "numbers", "differences of the camera's body angles"}};

}  // namespace

std::string calibrate_output_schema() {
  const std::string result = "results[]";
  return schema_of_parts("Rigproof calibrate --json",
                         {{{result, "", "one a method"},
                           {result + ".method", "text", "its name"},
                           {result + ".status", "solved | partial | refused", "whether everything was answered"},
                           {result + ".reasons[]", "", "why it is partial or refused"},
                           {result + ".notes[]", "", "what the user should know"}},
                          finding_keys(result + ".reasons"),
                          finding_keys(result + ".notes"),
                          exclusion_keys(result + ".use[].left_out"),
                          below(result + ".camera_to_robot[]", kTransform),
                          below(result + ".camera_to_camera[]", kTransform),
                          {{result + ".also_estimated[]?", "", "what else was estimated"},
                           {result + ".also_estimated[].camera", "text", "of which camera"},
                           {result + ".also_estimated[].name", "text", "what, with its unit"},
                           {result + ".also_estimated[].value", "number", "the estimate"},
                           {result + ".also_estimated[].sigma", "number", "its standard deviation"},
                           {result + ".also_estimated[].prior_sigma", "number", "what was believed before"},
                           {result + ".use[].camera", "text", "its name"},
                           {result + ".use[].used", "integer", "images that were used"},
                           {result + ".acceptance?", "", "with accept limits: whether they hold"},
                           {result + ".acceptance.criteria", "text", "the file that they are from"},
                           {result + ".acceptance.passed", "boolean", "whether all of them hold"},
                           {result + ".acceptance.notes[]", "", "what could not be checked"}},
                          finding_keys(result + ".acceptance.notes"),
                          below(result + ".acceptance.checks[]", kCheck)});
}

std::string validate_output_schema() {
  const std::string result = "results[]";
  return schema_of_parts(
      "Rigproof validate --json",
      {{{"tool", "text", "rigproof"},
        {"version", "text", "of the program"},
        {"passed", "boolean", "whether every gate is passed"},
        {result, "", "one a result"},
        {result + ".subject", "text", "what was validated"},
        {result + ".method", "text", "what estimated it"},
        {result + ".status", "solved | partial | refused", "whether everything was answered"},
        {result + ".reasons[]", "", "why it is partial or refused"},
        {result + ".passed", "boolean", "its gate"},
        {result + ".budget.name", "text", "file of the limits; empty = the default"},
        {result + ".budget.limits", "text", "the limits in words"},
        {result + ".degrees_of_freedom", "texts", "the axes of all lists of six"}},
       below(result + ".camera_to_robot[]", kError),
       below(result + ".camera_to_camera[]", kError),
       {{result + ".missing_cameras", "texts", "without a pose"},
        {result + ".nees", "", "normalised estimation error squared"},
        {result + ".nees.all", "number or null", "of all cameras together"},
        {result + ".nees.degrees_of_freedom", "integer", "what it should be on average"},
        {result + ".nees.interval_95?", "numbers", "where 95 of 100 lie"},
        {result + ".nees.cameras.NAME", "number", "of one camera, about 6"},
        {result + ".convention_suspicion", "anything", "a slip of conventions that explains the errors; or null"},
        {result + ".explanation", "text or null", "why the gate failed"}},
       below(result + ".checks[]", kCheck),
       finding_keys(result + ".reasons"),
       {{result + ".notes[]", "", "what could not be checked"}},
       finding_keys(result + ".notes")});
}

std::string observe_output_schema() {
  return schema_of_keys("Rigproof observe --json", {{"observations", "text", "the file that was written"},
                                                    {"stops", "integer", "how many"},
                                                    {"board_views", "integer", "how many"},
                                                    {"ground_planes", "integer", "how many"},
                                                    {"left_out", "integer", "how many"}});
}

std::string moved_output_schema() {
  const std::string axes = "tx_m ty_m tz_m rx_rad ry_rad rz_rad; null where nothing tells";
  return schema_of_parts(
      "Rigproof moved --json",
      {finding_keys("reasons"),
       finding_keys("notes"),
       {{"outcome", "nothing moved | moved | cannot tell", "the answer"},
        {"rig_moved", "boolean", "all cameras together against the robot"},
        {"chi_square", "number or null", "of all cameras together"},
        {"degrees_of_freedom", "integer", "of chi_square"},
        {"p_value", "number or null", "how likely so much is without a shift"},
        {"reasons[]", "", "why it cannot be told"},
        {"notes[]", "", "what the user should know"},
        {"cameras[].camera", "text", "its name"},
        {"cameras[].verdict", "text", "of this camera"},
        {"cameras[].p_value", "number or null", "how likely so much is without a shift"},
        {"cameras[].detectable_shift_m", "number or null", "that would be found with four in five chances"},
        {"cameras[].detectable_turn_rad", "number or null", "the same of a turn"},
        {"cameras[].shift.NAME", "number or null", axes},
        {"cameras[].sigma.NAME", "number or null", axes}}});
}

std::string suggest_output_schema() {
  const std::string axes = "one sigma: tx_m ty_m tz_m rx_rad ry_rad rz_rad; null where nothing tells";
  return schema_of_parts("Rigproof suggest --json",
                         {finding_keys("reasons_now"),
                          finding_keys("reasons_then"),
                          finding_keys("notes"),
                          {{"status_now", "solved | partial | refused", "of the data at hand"},
                           {"status_then", "solved | partial | refused", "with the stops that are suggested"},
                           {"reasons_now[]", "", "why it is partial or refused"},
                           {"reasons_then[]", "", "why it would be"},
                           {"notes[]", "", "what the user should know"},
                           {"stops[]", "", "where to drive, one after the other"},
                           {"stops[].command", "text", "in words"},
                           {"stops[].turn_before_deg", "number", "turn on the spot"},
                           {"stops[].distance_m", "number", "then drive straight"},
                           {"stops[].turn_after_deg", "number", "then turn again"},
                           {"stops[].x_m", "number", "place in the odometry's frame"},
                           {"stops[].y_m", "number", "place in the odometry's frame"},
                           {"stops[].yaw_deg", "number", "heading in the odometry's frame"},
                           {"stops[].cameras", "texts", "that see the board from there"},
                           {"cameras[].camera", "text", "its name"},
                           {"cameras[].now.NAME", "number or null", axes},
                           {"cameras[].then.NAME", "number or null", axes}}});
}

}  // namespace rigproof
