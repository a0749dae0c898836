// Writes images of a rig as COLMAP takes them: a folder a camera, those of a stop of one name, the rig's configuration
// in the keys of rig_bundle_adjuster (3.8) and of rig_configurator (3.12), and where the robot stood.
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/format.h"
#include "stop_images.h"

namespace rigproof {
namespace {

struct ColmapLens {
  std::string model, parameters;
};

// COLMAP's pixels begin at the corner of the top-left one, ours at its centre.
ColmapLens colmap_lens(const Camera& camera) {
  std::vector<double> numbers = {camera.fx_px, camera.fy_px, camera.cx_px + 0.5, camera.cy_px + 0.5};
  const auto& d = camera.distortion;
  std::string model = "PINHOLE";
  if (camera.lens == Lens::kBrownConrady) {
    model = "FULL_OPENCV";
    numbers.insert(numbers.end(), {d[0], d[1], d[2], d[3], d[4], 0.0, 0.0, 0.0});
  } else if (camera.lens == Lens::kKannalaBrandt) {
    model = "OPENCV_FISHEYE";
    numbers.insert(numbers.end(), {d[0], d[1], d[2], d[3]});
  }
  std::vector<std::string> words;
  for (const double number : numbers) words.push_back(number_text(number));
  return {model, joined(words, ",")};
}

std::string rig_entry(const RigCamera& camera, std::size_t k) {
  const ColmapLens lens = colmap_lens(camera.camera);
  std::string numbers = lens.parameters;
  for (std::size_t at = 0; (at = numbers.find(',', at)) != std::string::npos; at += 2) numbers.insert(at + 1, " ");
  return "    {\"camera_id\": " + std::to_string(k + 1) + ", \"image_prefix\": \"rig/" + camera.name + "/\"" +
         (k == 0 ? ", \"ref_sensor\": true" : "") + ", \"camera_model_name\": \"" + lens.model +
         "\",\n     \"camera_params\": [" + numbers + "]}";
}

std::string camera_line(const Camera& camera, std::size_t k) {
  const ColmapLens lens = colmap_lens(camera);
  std::string numbers = lens.parameters;
  for (char& c : numbers)
    if (c == ',') c = ' ';
  return std::to_string(k + 1) + " " + lens.model + " " + std::to_string(camera.width_px) + " " +
         std::to_string(camera.height_px) + " " + numbers + "\n";
}

std::string stops_text(const std::vector<StopFrames>& stops) {
  std::string text = "stop,x_m,y_m,yaw_rad\n";
  for (std::size_t i = 0; i < stops.size(); ++i)
    text += stop_number(i) + "," + number_text(stops[i].stop.x_m) + "," + number_text(stops[i].stop.y_m) + "," +
            number_text(stops[i].stop.yaw_rad) + "\n";
  return text;
}

ConvertReport write_colmap(const WriteJob& job) {
  ConvertReport report;
  std::vector<std::string> entries;
  std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
  for (std::size_t k = 0; k < job.recording.rig.cameras.size(); ++k) {
    const RigCamera& camera = job.recording.rig.cameras[k];
    copy_stop_images(job, k, "images/rig/" + camera.name, &report.images);
    entries.push_back(rig_entry(camera, k));
    cameras += camera_line(camera.camera, k);
  }
  write_file_atomically_unsynced(job.folder / "cameras.txt", cameras);
  write_file_atomically_unsynced(job.folder / "rig_config.json",
                                 "[{\"ref_camera_id\": 1, \"cameras\": [\n" + joined(entries, ",\n") + "\n]}]\n");
  write_file_atomically_unsynced(job.folder / "odometry.csv", stops_text(job.stops));
  report.notes.emplace_back("Depth, stamps and the board have no place in that layout.");
  return report;
}

}  // namespace

Format colmap_format() {
  Format format;
  format.name = "colmap";
  format.what = "COLMAP's folder of a rig";
  format.write = write_colmap;
  format.wants_stops = true;
  return format;
}

}  // namespace rigproof
