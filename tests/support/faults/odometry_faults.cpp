#include <cmath>

#include "recording_faults.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/draw_vector.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/core/text.h"

namespace rigproof::faults {
namespace {

using Codes = std::vector<std::string>;
using Samples = std::vector<OdometrySample>;
using EditSample = std::function<void(OdometrySample*)>;
using EditSamples = std::function<void(Samples*)>;

const Codes kTurns = {"odometry.turn_factor", "odometry.turns_contradict", "odometry.turns_scale"};
const Codes kDrift = {"odometry.yaw_drifts", "odometry.yaw_drifts_slightly", "odometry.turn_factor",
                      "odometry.turns_contradict"};
const Codes kNoisy = {"odometry.implausible", "odometry.mostly_outliers"};
const Codes kDead = {"odometry.dead", "odometry.constant"};

RecordingFault samples(const std::string& name, const Codes& codes, const EditSamples& edit) {
  return {name, "odometry", codes, {Files::kOdometry}, [edit](FaultyRecording* r) { r->edit_odometry(edit); }};
}

RecordingFault each(const std::string& name, const Codes& codes, const EditSample& edit) {
  return samples(name, codes, [edit](Samples* odometry) {
    for (OdometrySample& sample : *odometry) edit(&sample);
  });
}

RecordingFault text(const std::string& name, const Codes& codes,
                    const std::function<std::string(const std::string&)>& edit) {
  return {name, "odometry", codes, {Files::kOdometry}, [edit](FaultyRecording* r) { r->edit_odometry_text(edit); }};
}

Rigid3 pose_of(const OdometrySample& sample) { return planar_pose(sample.x_m, sample.y_m, sample.yaw_rad); }

void set_pose(const Rigid3& pose, OdometrySample* sample) {
  sample->x_m = pose.translation.x();
  sample->y_m = pose.translation.y();
  sample->yaw_rad = yaw_of(pose);
}

// Drives the same increments anew, each as `edit` makes it.
EditSamples increments(const std::function<Rigid3(const Rigid3& T_before_after, double duration_s)>& edit) {
  return [edit](Samples* odometry) {
    const Samples before = *odometry;
    for (std::size_t i = 1; i < before.size(); ++i)
      set_pose(pose_of((*odometry)[i - 1]) * edit(pose_of(before[i - 1]).inverse() * pose_of(before[i]),
                                                  before[i].stamp_s - before[i - 1].stamp_s),
               &(*odometry)[i]);
  };
}

EditSamples turning(double factor, double bias_rad_s) {
  return increments([=](const Rigid3& step, double duration_s) {
    return planar_pose(step.translation.x(), step.translation.y(), factor * yaw_of(step) + bias_rad_s * duration_s);
  });
}

// As wheels of unequal diameters do.
EditSamples veering(double rad_per_m) {
  return increments([=](const Rigid3& step, double) {
    const double yaw = yaw_of(step);
    const Rigid3 half = planar_pose(0.0, 0.0, 0.5 * yaw);
    const double forward_m = (half.inverse() * step).translation.x();
    return planar_pose(step.translation.x(), step.translation.y(), yaw + rad_per_m * forward_m);
  });
}

// All that comes after half time is moved as a body.
EditSamples jump(double x_m, double yaw_rad) {
  return [=](Samples* odometry) {
    const std::size_t half = odometry->size() / 2;
    const Rigid3 here = pose_of((*odometry)[half]);
    const Rigid3 after = here * planar_pose(x_m, 0.0, yaw_rad) * here.inverse();
    for (std::size_t i = half; i < odometry->size(); ++i) set_pose(after * pose_of((*odometry)[i]), &(*odometry)[i]);
  };
}

// Keeps the pose of its first sample over part of the drive.
EditSamples frozen(double from_share, double to_share) {
  return [=](Samples* odometry) {
    const double count = static_cast<double>(odometry->size());
    const auto from = static_cast<std::size_t>(from_share * count), to = static_cast<std::size_t>(to_share * count);
    for (std::size_t i = from; i < to; ++i) set_pose(pose_of((*odometry)[from]), &(*odometry)[i]);
  };
}

RecordingFault noisy(const std::string& name, double sigma_m, double sigma_rad) {
  return {name, "odometry", kNoisy, {Files::kOdometry}, [=](FaultyRecording* r) {
            RandomStream random = r->random("noise");
            r->edit_odometry(increments([&](const Rigid3& step, double) {
              const double yaw = random.normal(0.0, sigma_rad);
              const Eigen::Vector2d moved = draw_vector<2>([&] { return random.normal(0.0, sigma_m); });
              return step * planar_pose(moved.x(), moved.y(), yaw);
            }));
          }};
}

RecordingFault dropped(const std::string& name, double share) {
  return {name,
          "odometry",
          {"odometry.gap", "odometry.none", "odometry.not_covering", "odometry.misses_frames"},
          {Files::kOdometry},
          [share](FaultyRecording* r) {
            RandomStream random = r->random("dropped");
            r->edit_odometry([&](Samples* odometry) {
              Samples kept;
              for (const OdometrySample& sample : *odometry)
                if (kept.empty() || random.uniform() >= share) kept.push_back(sample);
              *odometry = kept;
            });
          }};
}

double rounded(double value, double step) { return step * std::round(value / step); }

void add_frames(std::vector<RecordingFault>* faults) {
  const auto metres = [faults](const std::string& unit, double factor) {
    faults->push_back(each("odometry in " + unit, {"odometry.unit"}, [factor](OdometrySample* sample) {
      sample->x_m *= factor;
      sample->y_m *= factor;
    }));
  };
  metres("millimetres", 1e3);
  metres("centimetres", 1e2);
  metres("feet", 1.0 / 0.3048);
  metres("inches", 1.0 / 0.0254);
  faults->push_back(each("odometry's yaw in degrees", {"odometry.yaw_in_degrees"},
                         [](OdometrySample* s) { s->yaw_rad = rad_to_deg(s->yaw_rad); }));
  faults->push_back(each("odometry's yaw of the wrong sign", {"odometry.yaw_sign"},
                         [](OdometrySample* s) { s->yaw_rad = -s->yaw_rad; }));
  faults->push_back(each("odometry mirrored", {"odometry.mirrored"}, [](OdometrySample* s) {
    s->y_m = -s->y_m;
    s->yaw_rad = -s->yaw_rad;
  }));
  faults->push_back(each("odometry's x and y swapped", {"odometry.axes_swapped"},
                         [](OdometrySample* s) { std::swap(s->x_m, s->y_m); }));
  faults->push_back(
      each("odometry's x of the wrong sign", {"odometry.axes_swapped"}, [](OdometrySample* s) { s->x_m = -s->x_m; }));
  faults->push_back(
      each("odometry's y of the wrong sign", {"odometry.axes_swapped"}, [](OdometrySample* s) { s->y_m = -s->y_m; }));
  faults->push_back(
      each("odometry inverted", {"odometry.inverted"}, [](OdometrySample* s) { set_pose(pose_of(*s).inverse(), s); }));
  faults->push_back(each("odometry in a frame turned by 40 deg", {}, [](OdometrySample* s) {
    set_pose(planar_pose(3.0, -2.0, deg_to_rad(40.0)) * pose_of(*s), s);
  }));
  faults->push_back(each("odometry's yaw between 0 and 360 deg", {}, [](OdometrySample* s) {
    s->yaw_rad = s->yaw_rad < 0.0 ? s->yaw_rad + 2.0 * kPi : s->yaw_rad;
  }));
}

// Of the robot's own frame: a calibration takes it as it is told.
void add_other_robot_frames(std::vector<RecordingFault>* faults) {
  const auto of_frame = [faults](const std::string& name, const Rigid3& T_robot_other, const std::string& why) {
    RecordingFault fault =
        each(name, {}, [T_robot_other](OdometrySample* sample) { set_pose(pose_of(*sample) * T_robot_other, sample); });
    fault.part = "convention";
    fault.cannot_show = why;
    faults->push_back(fault);
  };
  of_frame("odometry of a point 100 mm ahead of the robot's frame", planar_pose(0.1, 0.0, 0.0),
           "these are the files of a robot whose frame lies there, so that the best test has no power");
  of_frame("odometry's x turned by 2 deg in the robot", planar_pose(0.0, 0.0, deg_to_rad(2.0)),
           "these are the files of a robot whose frame is turned so, and the best test has no power");
}

void add_scales(std::vector<RecordingFault>* faults) {
  for (const double percent : {0.5, 1.0, 3.0, -10.0})
    faults->push_back(each(sized("odometry's way", percent, " %"),
                           {"odometry.scale", "odometry.translation_factor", "odometry.unit"},
                           [percent](OdometrySample* sample) {
                             sample->x_m *= 1.0 + percent / 100.0;
                             sample->y_m *= 1.0 + percent / 100.0;
                           }));
  for (const double percent : {0.5, 2.0, 5.0, -20.0})
    faults->push_back(samples(sized("odometry's turns", percent, " %"),
                              {"odometry.turn_factor", "odometry.turns_scale"}, turning(1.0 + percent / 100.0, 0.0)));
  for (const double deg_s : {0.01, 0.05, 0.2, 1.0})
    faults->push_back(samples(sized("gyro bias", deg_s, " deg/s"), kDrift, turning(1.0, deg_to_rad(deg_s))));
  for (const double deg_m : {0.1, 0.5, 2.0, 10.0})
    faults->push_back(samples(sized("odometry's heading", deg_m, " deg/m"), {"odometry.veers_far", "odometry.veers"},
                              veering(deg_to_rad(deg_m))));
}

void add_deaths(std::vector<RecordingFault>* faults) {
  const auto add = [faults](const std::string& name, const Codes& codes, const EditSamples& edit) {
    faults->push_back(samples(name, codes, edit));
  };
  add("odometry all zeros", kDead, frozen(0.0, 1.0));
  add("odometry frozen at half time", kDead, frozen(0.5, 1.0));
  add("odometry frozen over a fifth of the drive", kDead, frozen(0.4, 0.6));
  faults->push_back(each("odometry without turns", kDead, [](OdometrySample* s) { s->yaw_rad = 0.0; }));
  faults->push_back(each("odometry without a way", kDead, [](OdometrySample* s) { s->x_m = s->y_m = 0.0; }));
  const Codes slip = {"odometry.slip", "stop.contradicts", "odometry.row_contradicts"};
  for (const double mm : {20.0, 50.0, 200.0, 1000.0})
    add("odometry jumps by " + number_text(mm) + " mm", slip, jump(1e-3 * mm, 0.0));
  for (const double deg : {2.0, 5.0, 30.0})
    add("odometry jumps by " + number_text(deg) + " deg", slip, jump(0.0, deg_to_rad(deg)));
  add("odometry starts from zero at half time", slip, [](Samples* odometry) {
    const std::size_t half = odometry->size() / 2;
    const Rigid3 origin = pose_of((*odometry)[half]).inverse();
    for (std::size_t i = half; i < odometry->size(); ++i) set_pose(origin * pose_of((*odometry)[i]), &(*odometry)[i]);
  });
  faults->push_back(dropped("30 % of the odometry's rows dropped", 0.3));
  faults->push_back(dropped("90 % of the odometry's rows dropped", 0.9));
  add("odometry's second half missing",
      {"odometry.not_covering", "odometry.none", "camera.no_view", "camera.no_pose", "odometry.misses_frames"},
      [](Samples* odometry) { odometry->resize(odometry->size() / 2); });
  faults->push_back(noisy("odometry's noise x 10", 0.02, 0.1));
  faults->push_back(each("odometry's places rounded to 10 mm", {}, [](OdometrySample* s) {
    s->x_m = rounded(s->x_m, 0.01);
    s->y_m = rounded(s->y_m, 0.01);
  }));
  faults->push_back(each("odometry's places rounded to 100 mm", kNoisy, [](OdometrySample* s) {
    s->x_m = rounded(s->x_m, 0.1);
    s->y_m = rounded(s->y_m, 0.1);
  }));
  faults->push_back(each("odometry's yaw rounded to 0.1 rad", kNoisy,
                         [](OdometrySample* s) { s->yaw_rad = rounded(s->yaw_rad, 0.1); }));
}

// Each row as `row` writes it, with whatever head.
std::string rows_as(const std::string& csv, const std::string& head,
                    const std::function<std::string(const std::vector<std::string>& cells)>& row) {
  std::string result = head, line;
  std::size_t begin = csv.find('\n') + 1;
  for (std::size_t end; (end = csv.find('\n', begin)) != std::string::npos; begin = end + 1) {
    std::vector<std::string> cells(1);
    for (const char c : csv.substr(begin, end - begin)) {
      if (c == ',')
        cells.emplace_back();
      else
        cells.back() += c;
    }
    result += row(cells) + "\n";
  }
  return result;
}

void add_tables(std::vector<RecordingFault>* faults) {
  const auto add = [faults](const std::string& name, const Codes& codes, const std::string& head,
                            const std::function<std::string(const std::vector<std::string>&)>& row) {
    faults->push_back(text(name, codes, [head, row](const std::string& csv) { return rows_as(csv, head, row); }));
  };
  using Cells = std::vector<std::string>;
  add("odometry of eight columns without a header", {kError}, "", [](const Cells& c) {
    return joined({c[0], c[1], c[2], "0", "0", "0", number_text(std::sin(0.5 * std::stod(c[3]))),
                   number_text(std::cos(0.5 * std::stod(c[3])))},
                  ",");
  });
  add("odometry with decimal commas", {kError}, "", [](const Cells& c) {
    Cells commas;
    for (const std::string& cell : c) commas.push_back(fixed_text(std::stod(cell), 6));
    std::string row = joined(commas, ",");
    for (char& character : row) character = character == '.' ? ',' : character;
    return row;
  });
  add("odometry with semicolons", {kError}, "stamp_s;x_m;y_m;yaw_rad\n", [](const Cells& c) { return joined(c, ";"); });
  add("odometry's columns yaw x y without a header", {kError, "odometry.columns"}, "", [](const Cells& c) {
    return joined({c[0], c[3], c[1], c[2]}, ",");
  });
  add("odometry's header with x and y swapped", {"odometry.axes_swapped"}, "stamp_s,y_m,x_m,yaw_rad\n",
      [](const Cells& c) { return joined(c, ","); });
  add("odometry's yaw as a quaternion's z", {"odometry.yaw_of_quaternion"}, "stamp_s,x_m,y_m,yaw_rad\n",
      [](const Cells& c) {
        return joined({c[0], c[1], c[2], number_text(std::sin(0.5 * std::stod(c[3])))}, ",");
      });
  add("odometry of further columns under a header", {}, "seq,stamp_s,frame,x_m,y_m,z_m,yaw_rad\n", [](const Cells& c) {
    return joined({"7", c[0], "odom", c[1], c[2], "0", c[3]}, ",");
  });
}

}  // namespace

std::vector<RecordingFault> odometry_faults() {
  std::vector<RecordingFault> faults;
  add_frames(&faults);
  add_other_robot_frames(&faults);
  add_scales(&faults);
  add_deaths(&faults);
  add_tables(&faults);
  return faults;
}

}  // namespace rigproof::faults
