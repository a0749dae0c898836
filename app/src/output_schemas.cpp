#include "output_schemas.h"

#include <algorithm>
#include <cctype>

namespace rigproof {
namespace {

using Lines = std::vector<KeyLine>;

Lines finding_keys(const std::string& list, const std::string& what) {
  return {{list + "[]", "", what},
          {list + "[].sentence?", "text", "for people alone"},
          {list + "[].code", "text", "what was found; docs/reference/findings.md lists all"},
          {list + "[].severity", "note | suspect | left_out | refusal | contradiction | cause",
           "what it means for the result"},
          {list + "[].cameras?", "texts", "which it concerns"},
          {list + "[].axes?", "texts", "degrees of freedom that it concerns"},
          {list + "[].stops?", "numbers", "indices of stops that it concerns"},
          {list + "[].values?", "anything", "numbers and texts by name"},
          {list + "[].because[]?", "anything", "findings that speak for it"}};
}

// Puts a path before the lines of a part.
Lines below(const std::string& path, const Lines& lines) {
  Lines all;
  for (const KeyLine& line : lines) all.push_back({path + line.path, line.type, line.description});
  return all;
}

Lines all_of(const std::vector<Lines>& parts) {
  Lines all;
  for (const Lines& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

const Lines kCheck = {{".name", "text", "what is checked, of which camera"},
                      {".code", "text", "of the finding that failed it without a value; else empty"},
                      {".passed", "boolean", "whether it holds"},
                      {".value", "number or null", "what was found; null where there is none"},
                      {".limit", "number or null", "what is allowed"},
                      {".unit", "text", "of value and limit"},
                      {".reason", "text", "why it failed without a value; else empty"}};

const Lines kLeftOut = {{".stop", "integer", "index of the stop; -1 = none"},
                        {".file", "text", "the image"},
                        {".sentence", "text", "for people alone"},
                        {".code", "text", "why; docs/reference/findings.md lists all"},
                        {".depth", "boolean", "whether only its depth is left out"}};

const Lines kFailures = {{"failures[].method", "text", "its name"},
                         {"failures[].status", "text", "how it ended"},
                         {"failures[].code", "text", "of the first finding"},
                         {"failures[].reason", "text", "why"},
                         {"failures[].tasks", "integer", "how many ended so"}};

const Lines kSummary = {{"name", "text", "of the sweep"},
                        {"axes", "texts", "what is varied"},
                        {"methods", "texts", "that answered"},
                        {"reference", "text", "method that the others are compared with"},
                        {"rows[]", "anything", "a line of summary.csv: levels by axis, then its columns"}};

const Lines kMachines = {{"machines[].host", "text", "that answered"},
                         {"machines[].cpu", "text", "its processor"},
                         {"machines[].gl_renderer", "text", "that drew its pictures; empty without pictures"},
                         {"machines[].answers", "integer", "how many"}};

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

Lines calibrate_keys() {
  const std::string result = "results[]";
  return all_of({{{result, "", "one a method"},
                  {result + ".method", "text", "its name"},
                  {result + ".status", "solved | partial | refused", "whether everything was answered"}},
                 finding_keys(result + ".reasons", "why it is partial or refused"),
                 finding_keys(result + ".notes", "what the user should know"),
                 below(result + ".use[].left_out[]", kLeftOut),
                 below(result + ".camera_to_robot[]", kTransform),
                 below(result + ".camera_to_camera[]", kTransform),
                 {{result + ".also_estimated[]?", "", "what else was estimated"},
                  {result + ".also_estimated[].camera", "text",
                   "of which camera; of what cameras of one sensor share, of the first"},
                  {result + ".also_estimated[].name", "text", "what, with its unit"},
                  {result + ".also_estimated[].value", "number", "the estimate"},
                  {result + ".also_estimated[].sigma", "number", "its standard deviation"},
                  {result + ".also_estimated[].prior_sigma", "number", "what was believed before"},
                  {result + ".boards[]?", "", "with more_boards: where they stand against the first one"},
                  {result + ".boards[].number", "integer", "2 is the first of more_boards"},
                  {result + ".boards[].translation_m", "numbers", "in the frame of the first board"},
                  {result + ".boards[].quaternion_xyzw", "numbers", "the same"},
                  {result + ".boards[].sigmas_mm", "numbers", "one sigma along each axis of the first board"},
                  {result + ".boards[].sigmas_deg", "numbers", "one sigma about each axis of this board"},
                  {result + ".use[].camera", "text", "its name"},
                  {result + ".use[].used", "integer", "images that were used"},
                  {result + ".acceptance?", "", "with accept limits: whether they hold"},
                  {result + ".acceptance.criteria", "text", "the file that they are from"},
                  {result + ".acceptance.passed", "boolean", "whether all of them hold"}},
                 finding_keys(result + ".acceptance.notes", "what could not be checked"),
                 below(result + ".acceptance.checks[]", kCheck)});
}

Lines validate_keys() {
  const std::string result = "results[]";
  return all_of(
      {{{"tool", "text", "rigproof"},
        {"version", "text", "of the program"},
        {"passed", "boolean", "whether every gate is passed"},
        {result, "", "one a result"},
        {result + ".subject", "text", "what was validated"},
        {result + ".method", "text", "what estimated it"},
        {result + ".status", "solved | partial | refused", "whether everything was answered"}},
       finding_keys(result + ".reasons", "why it is partial or refused"),
       {{result + ".passed", "boolean", "its gate"},
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
        {result + ".convention_suspicion", "anything",
         "a wrong convention that explains the errors, in words (`explanation`) and as a finding (`conventions`), and "
         "the worst camera's errors as given and corrected; or null"},
        {result + ".explanation", "text or null", "why the gate failed, for people alone"}},
       finding_keys(result + ".causes", "the one cause of all that failed, as `explanation` has it in words; or none"),
       below(result + ".checks[]", kCheck),
       finding_keys(result + ".notes", "what could not be checked")});
}

Lines moved_keys() {
  const std::string axes = "tx_m ty_m tz_m rx_rad ry_rad rz_rad; null where nothing tells";
  return all_of({finding_keys("reasons", "why it cannot be told"),
                 finding_keys("notes", "what the user should know"),
                 {{"outcome", "nothing moved | moved | cannot tell", "the answer"},
                  {"rig_moved", "boolean", "all cameras together against the robot"},
                  {"chi_square", "number or null", "of all cameras together"},
                  {"degrees_of_freedom", "integer", "of chi_square"},
                  {"p_value", "number or null", "how likely so much is without a shift"},
                  {"cameras[].camera", "text", "its name"},
                  {"cameras[].verdict", "text", "of this camera"},
                  {"cameras[].p_value", "number or null", "how likely so much is without a shift"},
                  {"cameras[].detectable_shift_m", "number or null", "that the test finds with 90 % probability"},
                  {"cameras[].detectable_turn_rad", "number or null", "the same of a turn"},
                  {"cameras[].shift.NAME", "number or null", axes},
                  {"cameras[].sigma.NAME", "number or null", axes}}});
}

Lines suggest_keys() {
  const std::string axes = "one sigma: tx_m ty_m tz_m rx_rad ry_rad rz_rad; null where nothing tells";
  return all_of({finding_keys("reasons_now", "why it is partial or refused"),
                 finding_keys("reasons_then", "why it would be"),
                 finding_keys("notes", "what the user should know"),
                 {{"status_now", "solved | partial | refused", "of the data at hand"},
                  {"status_then", "solved | partial | refused", "with the stops that are suggested"},
                  {"stops[]", "", "where to drive, one after the other"},
                  {"stops[].command", "text", "in words"},
                  {"stops[].turn_before_deg", "number", "turn on the spot"},
                  {"stops[].distance_m", "number", "then drive straight"},
                  {"stops[].turn_after_deg", "number", "then turn again"},
                  {"stops[].x_m", "number", "place in the odometry's frame"},
                  {"stops[].y_m", "number", "place in the odometry's frame"},
                  {"stops[].yaw_deg", "number", "heading in the odometry's frame"},
                  {"stops[].cameras", "texts", "that see the board from there"},
                  {"stops[].hoped", "texts", "that have not seen it and may see it from there"},
                  {"nothing_helps", "boolean", "no further stop would make a sigma that matters smaller"},
                  {"cameras[].camera", "text", "its name"},
                  {"cameras[].now.NAME", "number or null", axes},
                  {"cameras[].then.NAME", "number or null", axes}}});
}

Lines export_keys() {
  return {{"to", "text", "the format"},
          {"result", "text", "the file that was exported"},
          {"status", "solved | partial | refused", "whether everything was answered"},
          {"remarks", "texts", "what the user should know, in words"},
          {"notes", "texts", "what the format has no place for, and how links were read, in words"},
          {"text?", "text", "the export, where no file was named"},
          {"files[]", "", "that were written"},
          {"files[].file", "text", "its name"},
          {"files[].backup", "text or null", "what was there before"},
          {"files[].changed", "boolean", "false: it held the same bytes"},
          {"joints[]", "", "that --into gave a new origin"},
          {"joints[].camera", "text", "that it is for"},
          {"joints[].joint", "text", "its name"},
          {"joints[].line", "integer", "of the file"},
          {"joints[].parent", "text", "link"},
          {"joints[].child", "text", "link"},
          {"joints[].optical_frame", "text", "link that the camera's pose was taken for"},
          {"joints[].before", "", "its origin as it was; empty where nothing was given"},
          {"joints[].before.NAME", "text", "xyz, rpy"},
          {"joints[].after", "", "its origin"},
          {"joints[].after.NAME", "text", "xyz, rpy"},
          {"joints[].moved_m", "number", "how far"},
          {"joints[].turned_rad", "number", "how far"},
          {"joints[].others", "texts", "joints that --joint could have named"}};
}

Lines init_keys() {
  return all_of(
      {{{"recording", "text", "the folder that was made"},
        {"robot_frame", "text", "frame that results are given in"},
        {"odometry.topic", "text", "where it came from"},
        {"odometry.rows", "integer", "poses"},
        {"odometry.duration_s", "number", "from the first to the last"},
        {"odometry.tilt_deg", "number", "largest angle between the robot's vertical and the odometry frame's"},
        {"odometry.rise_m", "number", "highest less lowest position"},
        {"stops", "integer", "places at which the robot stood still and images were taken"},
        {"moving_images", "integer", "left out, because the robot moved"}},
       below("cameras[]",
             {{".name", "text", "of the camera"},
              {".images", "text", "topic"},
              {".camera_info", "text", "topic or file"},
              {".depth", "text or null", "topic"},
              {".link", "text", "by which the camera is mounted"},
              {".width_px", "integer", "of its images"},
              {".height_px", "integer", "of its images"},
              {".images_in_source", "integer", "how many there are"},
              {".images_kept", "integer", "how many were written"},
              {".depth_kept", "integer", "depth images written"},
              {".stops", "integer", "stops with an image of it"},
              {".board_stops", "integer or null", "those with the whole board in it; null: not looked for"},
              {".cells", "integer or null", "parts of its image with a corner of the board, of 8 x 6; likewise"}}),
       {{"notes", "texts", "for people"},
        {"missing", "texts", "what rig.yaml still needs, for people"},
        {"bytes", "integer", "of the source"},
        {"unpacked_bytes", "integer", "of its messages"}}});
}

Lines record_check_keys() {
  return all_of({{{"stops", "integer", "places at which images were taken"},
                  {"duration_s", "number", "from the first stop to the last"},
                  {"board", "text", "type and squares; empty: not known"},
                  {"board_guessed", "boolean", "the images told which board it is"},
                  {"waiting", "integer", "images that are not whole yet"}},
                 below("cameras[]", {{".name", "text", "of the camera"},
                                     {".stops", "integer", "stops with an image of it"},
                                     {".board_stops", "integer", "those with the whole board in it"},
                                     {".cells", "integer", "parts of its image with a corner of the board, of 8 x 6"},
                                     {".edge_px", "number or null", "width of the board's edges, the median"},
                                     {".blurred", "integer", "stops"},
                                     {".overexposed", "integer", "stops"},
                                     {".underexposed", "integer", "stops"},
                                     {".unreadable", "integer", "stops"}}),
                 finding_keys("cameras[].left_out", "why images show no board, each with its count"),
                 {{"pairs[].cameras", "texts", "two cameras"},
                  {"pairs[].stops", "integer", "at which both have the board"},
                  {"next[].cameras", "texts", "that it is for"},
                  {"next[].turn_deg", "number", "turn to the left, from `from_stop`; 0: drive nearer or farther"},
                  {"next[].from_stop", "integer", "the stop at which the robot stands, or is to stand"},
                  {"next[].image_part", "text or null", "third of the image without the board; null: never seen"},
                  {"next[].text", "text", "in words"}}});
}

Lines observe_keys() {
  return {{"observations", "text", "the file that was written"},
          {"stops", "integer", "how many"},
          {"board_views", "integer", "how many"},
          {"ground_planes", "integer", "how many"},
          {"left_out", "integer", "how many"}};
}

Lines generate_keys() {
  return {{"run", "text", "the folder"},
          {"images", "integer", "how many it has"},
          {"images_rendered", "integer", "how many were not there before"},
          {"bytes", "integer", "of all files"},
          {"seconds", "number", "that it took"},
          {"gl_renderer", "text", "what drew"},
          {"coverage", "text", "what the viewpoints cover, in words"}};
}

Lines generate_dry_run_keys() {
  return {{"stops", "integer", "of the robot"},
          {"images", "integer", "that would be written"},
          {"pictures", "integer", "that would be drawn for them"},
          {"expected_mb", "number", "of all files"},
          {"expected_minutes", "number", "that it would take"},
          {"output", "text", "the folder"},
          {"coverage", "text", "what the viewpoints cover, in words"},
          {"cameras[].name", "text", "the camera"},
          {"cameras[].board_stops", "integer", "stops with the whole board in its image"},
          {"cameras[].cells", "integer", "parts of its image with a corner of the board, of 8 x 6"},
          {"cameras[].possible_cells", "integer", "parts that this or any other drive could show it"},
          {"cameras[].top_row_px", "number", "row of the uppermost corner; 0: none"},
          {"cameras[].bottom_row_px", "number", "row of the lowest corner; 0: none"}};
}

Lines sense_keys() {
  return {{"run", "text", "the folder"},
          {"images", "integer", "how many it has"},
          {"bytes", "integer", "of all files"},
          {"seconds", "number", "that it took"},
          {"seed", "integer", "of the sensors' noise"}};
}

Lines doctor_keys() {
  return {{"version", "text", "of the program"},
          {"mujoco", "text", "its version"},
          {"data", "text", "folder of models and scenes"},
          {"cores", "integer", "of this machine"},
          {"gl_renderer", "text", "what drew"},
          {"gl_version", "text", "of OpenGL"},
          {"problem", "text", "why nothing can be drawn; else empty"},
          {"devices[].device", "integer", "as --device takes it"},
          {"devices[].name", "text", "of the device"},
          {"devices[].drm_file", "text", "its file"},
          {"devices[].software", "boolean", "whether the processor draws"}};
}

Lines doctor_of_run_keys() {
  return all_of({{{"good", "boolean", "whether all is as it should be"},
                  {"files", "integer", "that were compared with the manifest"},
                  {"integrity_problems", "texts", "files that are not as they were written"},
                  {"convention_problems", "texts", "what contradicts the truth, for people alone"}},
                 finding_keys("convention_findings", "the same")});
}

Lines convert_keys() {
  return {{"output", "text", "the folder, or the bag"},
          {"layout", "text", "that it has"},
          {"images", "integer", "how many"},
          {"clouds", "integer", "how many"},
          {"notes", "texts", "what could not be said in that layout"}};
}

Lines bench_export_keys() {
  return {{"output", "text", "the folder of the layout"},
          {"layout", "text", "that it has"},
          {"images", "integer", "how many"},
          {"bytes", "integer", "of all files"},
          {"truth", "text", "the file to judge by"}};
}

Lines scenes_of_one_keys() {
  return {{"[].name", "text", "of the scene"},
          {"[].planned_board_whole_share", "number", "of views that have the whole board, as planned"},
          {"[].planned_board_at_every_stop", "boolean", "whether a camera has it at each"},
          {"[].boards_visible", "integer", "how many"},
          {"[].boards_found", "integer", "how many of them"},
          {"[].depth_images", "integer", "how many"},
          {"[].grounds_found", "integer", "in how many of them"},
          {"[].worst_normal_deg", "number", "error of the ground's normal"},
          {"[].worst_height_mm", "number", "error of its distance"},
          {"[].least_floor_share", "number", "of the points of a depth image"},
          {"[].keypoints", "number", "in an image, on average"},
          {"[].good", "boolean", "whether board and ground are found"}};
}

Lines sensors_plot_keys() {
  return {{"sensor", "text", "its name"},
          {"picture", "text", "the file"},
          {"points[].z_m", "number", "distance"},
          {"points[].law_mm", "number", "noise by the preset"},
          {"points[].recorded_mm", "number", "with rounding"},
          {"points[].realised_mm", "number", "of the simulated sensor"},
          {"points[].mean_error_mm", "number", "of the simulated sensor"}};
}

Lines sweep_start_keys() {
  return all_of({kSummary,
                 {{"folder?", "text", "of the tables"},
                  {"seconds?", "number", "that it took"},
                  {"counters.NAME", "integer", "what was done in this start"}},
                 kFailures});
}

Lines sweep_start_dry_run_keys() {
  return {{"folder", "text", "of the tables"},
          {"points", "integer", "combinations of levels"},
          {"tasks", "integer", "runs"},
          {"answers", "integer", "of all methods"},
          {"answers_there", "integer", "of them"},
          {"picture_sets", "integer", "sets of clean renders"},
          {"picture_sets_there", "integer", "of them"},
          {"images_to_render", "integer", "how many"},
          {"expected_mb", "number", "on disk"},
          {"expected_minutes", "number", "that it would take"},
          {"answers_not_timed", "integer", "of programs from outside, counted with a second each"},
          {"task_lines", "texts", "each task in words"},
          {"cannot_run", "texts", "methods that cannot run, and why"}};
}

Lines sweep_run_keys() {
  return {{"folder", "text", "of the sweep"},
          {"shard", "text", "INDEX/COUNT"},
          {"answers", "integer", "of the shard"},
          {"seconds", "number", "that it took"},
          {"counters.NAME", "integer", "what was done in this start"}};
}

Lines sweep_slurm_keys() {
  return {{"run", "text", "script of the job array"},
          {"merge", "text", "script of the merge"},
          {"submit", "text", "script that submits both"},
          {"array", "integer", "array tasks"}};
}

Lines sweep_status_keys() {
  return all_of({{{"name", "text", "of the sweep"},
                  {"tasks", "integer", "runs"},
                  {"answers", "integer", "of all methods"},
                  {"answers_there", "integer", "of them"},
                  {"running", "boolean", "whether a process works on it"},
                  {"counters.NAME", "integer", "what was done in all starts"}},
                 kMachines,
                 kFailures});
}

Lines paper_keys() {
  return {{"[].name", "text", "of the experiment"},
          {"[].title", "text", "of the experiment"},
          {"[].config", "text", "the sweep that it is"}};
}

Lines paper_of_one_keys() {
  return {{"tables[].title", "text", "of the table"},
          {"tables[].head", "texts", "names of the columns"},
          {"tables[].rows[]", "texts", "a row"},
          {"tables[].notes", "texts", "below the table"},
          {"files", "texts", "that were written"}};
}

Lines paper_dry_run_keys() {
  return {{"tasks", "integer", "runs"},
          {"answers", "integer", "of all methods"},
          {"answers_there", "integer", "of them"},
          {"images_to_render", "integer", "how many"},
          {"megabytes", "number", "on disk"},
          {"minutes", "number", "that it would take"}};
}

}  // namespace

std::vector<OutputSchema> output_schemas() {
  return {{"calibrate", "", calibrate_keys()},
          {"validate", "; `run --json` is the same", validate_keys()},
          {"observe", "", observe_keys()},
          {"init", "", init_keys()},
          {"record-check", "; with --follow one a line for each change", record_check_keys()},
          {"moved", "", moved_keys()},
          {"suggest", "", suggest_keys()},
          {"generate", "; of several runs a list of these", generate_keys()},
          {"generate --dry-run", "; of several runs a list of these", generate_dry_run_keys()},
          {"sense", "", sense_keys()},
          {"doctor", "", doctor_keys()},
          {"doctor RUN", "", doctor_of_run_keys()},
          {"convert", "", convert_keys()},
          {"bench export", "", bench_export_keys()},
          {"export", "", export_keys()},
          {"inspect", "", {{"[]", "text", "a picture that was written"}}},
          {"report", "", {{"report", "text", "the file that was written"}}},
          {"board", "", {{"file", "text", "that was written"}, {"pages", "integer", "of it"}}},
          {"methods",
           "; scenes, rigs, robots, sensors and boards likewise, each with facts of its own",
           {{"[].name", "text", "what it is called"}, {"[].NAME", "text", "a fact, in words"}}},
          {"scenes SCENE", "", scenes_of_one_keys()},
          {"sensors --plot NAME", "", sensors_plot_keys()},
          {"sweep start", "", sweep_start_keys()},
          {"sweep start --dry-run", "", sweep_start_dry_run_keys()},
          {"sweep plan", "", {{"folder", "text", "of the sweep"}, {"tasks", "integer", "distinct ones"}}},
          {"sweep run", "", sweep_run_keys()},
          {"sweep merge", "",
           all_of({kSummary, {{"missing[]", "text", "an answer that is not there"}}, kMachines, kFailures})},
          {"sweep slurm", "", sweep_slurm_keys()},
          {"sweep status", "", sweep_status_keys()},
          {"paper", "", paper_keys()},
          {"paper NAME", "", paper_of_one_keys()},
          {"paper NAME --dry-run", "", paper_dry_run_keys()}};
}

std::string name_of(const OutputSchema& output) {
  std::string name;
  for (const char c : output.command)
    if (c != '-' || (!name.empty() && name.back() != '_'))
      name += c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(c));
  return name + "_output";
}

// json_text() gives every object one.
std::string schema_of(const OutputSchema& output) {
  const auto is_version = [](const KeyLine& line) { return line.path == "version"; };
  const bool is_list = output.keys.front().path.rfind("[]", 0) == 0;
  Lines keys = output.keys;
  if (!is_list && std::none_of(keys.begin(), keys.end(), is_version))
    keys.insert(keys.begin(), {"version", "text", "of the program"});
  return schema_of_keys("Rigproof " + output.command + " --json", keys);
}

}  // namespace rigproof
