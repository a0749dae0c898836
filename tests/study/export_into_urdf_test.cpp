// `export --into`: one origin changes, every other byte stays, and what cannot be done is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>

#include "error_text.h"
#include "export_job.h"
#include "pose_near.h"
#include "rigproof/study/export/into_urdf.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Ten decimals of metres and radians.
constexpr double kNear = 1e-9;

// A robot as files have them: base_link is not the robot frame, the camera is a device with an optical frame of its
// own.
const std::string kRobot =
    "<?xml version='1.0'?>\n"
    "<robot name=\"r\"  xmlns:xacro='http://www.ros.org/wiki/xacro'>\n"
    "  <!-- <origin xyz=\"9 9 9\"/> --><link name=\"base_footprint\"/><link name=\"base_link\"/>\n"
    "  <joint name='base_joint' type='fixed'><parent link='base_link'/><child link='base_footprint'/>"
    "<origin xyz='0 0 -0.1' rpy='0 0 0.2'/></joint>\n"
    "  <joint name=\"camera_joint\" type=\"fixed\">\n"
    "    <origin   rpy='0 0.1 0'\n            xyz = \"0.1  0 0.5\" />\n"
    "    <parent link=\"base_link\"/>\n    <child link=\"camera_link\"/>\n  </joint>\n"
    "  <link name=\"camera_link\"/>\n"
    "  <joint name=\"camera_color_joint\" type=\"fixed\"><parent link=\"camera_link\"/><child "
    "link=\"camera_color_frame\"/><origin xyz=\"0.01 0.02 0.03\"/></joint>\n"
    "  <link name=\"camera_color_frame\"/>\n"
    "  <joint name=\"camera_color_optical_joint\" type=\"fixed\"><parent link=\"camera_color_frame\"/><child "
    "link=\"camera_color_optical_frame\"/><origin xyz=\"0 0 0\" rpy=\"-1.5707963 0 -1.5707963\"/></joint>\n"
    "  <link name=\"camera_color_optical_frame\"/>\n"
    "  <joint name=\"camera_depth_joint\" type=\"fixed\"><parent link=\"camera_link\"/><child "
    "link=\"camera_depth_optical_frame\"/></joint>\n"
    "  <link name=\"camera_depth_optical_frame\"/>\n"
    "  <joint name=\"head_joint\" type=\"revolute\"><parent link=\"base_link\"/><child link=\"head\"/>"
    "<axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>\n"
    "  <link name=\"head\"/>\n"
    "  <transmission name=\"t\"><joint name=\"camera_joint\"/></transmission>\n"
    "</robot>\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// One camera `cam` somewhere in the robot.
struct OneCamera {
  ExportJob job;

  explicit OneCamera(const std::string& link = "camera_link", const std::string& optical = "") {
    RandomStream random(5, "into");
    ExportCamera camera;
    camera.name = "cam";
    camera.estimate = pose_of("cam", random_transform(random));
    camera.link = link;
    camera.optical_frame = optical;
    job.cameras = {camera};
  }
  ExportCamera& camera() { return job.cameras[0]; }
  IntoUrdf into(const std::string& text) const { return export_into_urdf(job, text, "robot.urdf"); }
  std::string problem(const std::string& text) const {
    return error_text([&] { into(text); });
  }
};

Rigid3 T_joint(const urdf::Joint& joint) {
  const urdf::Pose& pose = joint.parent_to_joint_origin_transform;
  const urdf::Rotation& q = pose.rotation;
  return {Eigen::Quaterniond(q.w, q.x, q.y, q.z), {pose.position.x, pose.position.y, pose.position.z}};
}

// As urdfdom has it.
Rigid3 T_root_link(const urdf::ModelInterface& model, const std::string& link) {
  const auto& joint = model.getLink(link)->parent_joint;
  return joint == nullptr ? Rigid3() : T_root_link(model, joint->parent_link_name) * T_joint(*joint);
}

Rigid3 T_from_to(const std::string& text, const std::string& from, const std::string& to) {
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (model == nullptr) throw std::runtime_error("urdfdom: no URDF:\n" + text);
  return T_root_link(*model, from).inverse() * T_root_link(*model, to);
}

void expect_camera_at(const std::string& urdf, const std::string& link, const Rigid3& T) {
  EXPECT_TRUE(IsPoseNear(T, T_from_to(urdf, "base_footprint", link), kNear, kNear));
}

// The part of `after` that stands where `before` has something else.
std::string difference(const std::string& before, const std::string& after) {
  const auto from = std::mismatch(before.begin(), before.end(), after.begin(), after.end());
  const auto most = static_cast<std::size_t>(std::min(before.end() - from.first, after.end() - from.second));
  std::size_t same = 0;
  while (same < most && before[before.size() - 1 - same] == after[after.size() - 1 - same]) ++same;
  return {from.second, after.end() - static_cast<std::ptrdiff_t>(same)};
}

// --------------------------------------------------------------------------------------------------- what it changes

TEST(IntoUrdf, OneOriginChangesAndTheOpticalFrameIsWhereItWasSeen) {
  const OneCamera cam;
  const IntoUrdf into = cam.into(kRobot);
  expect_camera_at(into.text, "camera_color_optical_frame", cam.job.cameras[0].estimate.T_parent_child);
  ASSERT_EQ(into.joints.size(), 1U);
  const ChangedJoint& joint = into.joints[0];
  EXPECT_EQ(joint.joint, "camera_joint");
  EXPECT_EQ(joint.line, 5);
  EXPECT_EQ(joint.optical, "camera_color_optical_frame");
  EXPECT_EQ(joint.xyz_before, "0.1  0 0.5");
  EXPECT_EQ(joint.rpy_before, "0 0.1 0");
  EXPECT_THAT(joint.others, ElementsAre("camera_color_joint", "camera_color_optical_joint"));
  std::string expected = replaced(kRobot, "rpy='0 0.1 0'", "rpy='" + joint.rpy_after + "'");
  expected = replaced(expected, "\"0.1  0 0.5\"", "\"" + joint.xyz_after + "\"");
  EXPECT_EQ(into.text, expected);
  const Vector6d moved =
      transform_error(T_from_to(into.text, "base_link", "camera_link"), T_from_to(kRobot, "base_link", "camera_link"));
  EXPECT_NEAR(joint.moved_m, moved.head<3>().norm(), 1e-8);
  EXPECT_NEAR(joint.turned_rad, moved.tail<3>().norm(), 1e-8);
}

TEST(IntoUrdf, TheSameAgainChangesNothing) {
  const OneCamera cam;
  const IntoUrdf once = cam.into(kRobot), twice = cam.into(once.text);
  EXPECT_EQ(once.text, twice.text);
  EXPECT_LT(twice.joints[0].moved_m, kNear);
  EXPECT_TRUE(twice.notes.empty());
}

TEST(IntoUrdf, LineEndsByteOrderMarkAndQuotesStay) {
  std::string text = "\xef\xbb\xbf" + kRobot;
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 2)) text.insert(at, "\r");
  const OneCamera cam;
  const IntoUrdf into = cam.into(text);
  std::string expected = replaced(text, "0 0.1 0", into.joints[0].rpy_after);
  expected = replaced(expected, "0.1  0 0.5", into.joints[0].xyz_after);
  EXPECT_EQ(into.text, expected);
  EXPECT_EQ(into.joints[0].line, 5);
}

TEST(IntoUrdf, MissingAttributesAndOriginsAreMade) {
  const std::string origin = "<origin   rpy='0 0.1 0'\n            xyz = \"0.1  0 0.5\" />";
  const OneCamera cam;
  const Rigid3& T = cam.job.cameras[0].estimate.T_parent_child;
  const std::string only_rpy = replaced(kRobot, origin, "<origin rpy=\"1 2 3\" />");
  EXPECT_THAT(difference(only_rpy, cam.into(only_rpy).text), HasSubstr("xyz=\""));
  expect_camera_at(cam.into(only_rpy).text, "camera_color_optical_frame", T);
  const std::string empty = replaced(kRobot, origin, "<origin/>");
  expect_camera_at(cam.into(empty).text, "camera_color_optical_frame", T);
  const std::string none = replaced(kRobot, "    " + origin + "\n", "");
  const IntoUrdf into = cam.into(none);
  expect_camera_at(into.text, "camera_color_optical_frame", T);
  EXPECT_EQ(into.joints[0].xyz_before, "");
  // A line of its own, indented as its neighbours.
  EXPECT_EQ(into.text,
            replaced(none, "type=\"fixed\">\n    <parent link=\"base_link\"/>\n    <child link=\"camera_link\"/>",
                     "type=\"fixed\">\n    <origin xyz=\"" + into.joints[0].xyz_after + "\" rpy=\"" +
                         into.joints[0].rpy_after +
                         "\"/>\n    <parent link=\"base_link\"/>\n    <child link=\"camera_link\"/>"));
}

// Looking straight down is where roll and yaw are one angle.
TEST(IntoUrdf, CamerasThatLookDownStayPrecise) {
  OneCamera cam;
  for (const double tilt : {0.0, 1e-10, 3e-9, 1e-7, 1e-4}) {
    cam.camera().estimate.T_parent_child =
        Rigid3(so3_exp({0.0, 0.0, 0.7}) * so3_exp({kPi - tilt, 0.0, 0.0}), {0.2, 0.1, 0.9});
    expect_camera_at(cam.into(kRobot).text, "camera_color_optical_frame", cam.camera().estimate.T_parent_child);
  }
}

// The file's chain counts where it has one; where not, what the bag's tree said.
TEST(IntoUrdf, FramesOfTheRigAreTaken) {
  OneCamera cam("camera_link", "camera_color_optical_frame");
  cam.camera().T_link_camera = Rigid3(Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.0, 0.5, 0.0});
  cam.camera().rig_says_frames = true;
  const IntoUrdf into = cam.into(kRobot);
  EXPECT_EQ(into.joints.at(0).joint, "camera_joint");
  expect_camera_at(into.text, "camera_color_optical_frame", cam.camera().estimate.T_parent_child);
  EXPECT_THAT(into.notes, testing::Contains(HasSubstr("elsewhere in camera_link than the rig says")));
  cam.camera().T_link_camera = T_from_to(kRobot, "camera_link", "camera_color_optical_frame");
  EXPECT_THAT(cam.into(kRobot).notes, testing::Not(testing::Contains(HasSubstr("elsewhere"))));

  cam.camera().optical_frame = "published_by_the_driver";
  const std::string driven = cam.into(kRobot).text;
  EXPECT_TRUE(IsPoseNear(cam.camera().estimate.T_parent_child,
                         T_from_to(driven, "base_footprint", "camera_link") * *cam.camera().T_link_camera, kNear,
                         kNear));
}

// ------------------------------------------------------------------------------------------------ which joint it is

TEST(IntoUrdf, AnOpticalFrameFindsTheJointOfItsDevice) {
  for (const OneCamera& cam :
       {OneCamera("camera_color_optical_frame"), OneCamera("cam", "camera_color_optical_frame")}) {
    const IntoUrdf into = cam.into(kRobot);
    EXPECT_EQ(into.joints[0].joint, "camera_joint");
    expect_camera_at(into.text, "camera_color_optical_frame", cam.job.cameras[0].estimate.T_parent_child);
  }
}

TEST(IntoUrdf, AJointCanBeNamed) {
  OneCamera cam;
  cam.camera().joint = "camera_color_joint";
  const IntoUrdf into = cam.into(kRobot);
  EXPECT_EQ(into.joints[0].joint, "camera_color_joint");
  EXPECT_EQ(into.joints[0].rpy_before, "");
  expect_camera_at(into.text, "camera_color_optical_frame", cam.camera().estimate.T_parent_child);
  cam.camera().joint = "camera_depth_joint";
  EXPECT_THAT(cam.problem(kRobot), HasSubstr("does not lie between base_footprint and camera_color_optical_frame"));
  cam.camera().joint = "camera_jiont";
  EXPECT_THAT(cam.problem(kRobot), HasSubstr("did you mean \"camera_joint\"?"));
}

TEST(IntoUrdf, WhatTheDriverPublishesNeedsNoFrameInTheFile) {
  OneCamera cam("camera_link");
  RandomStream random(6, "driver");
  cam.camera().T_link_camera = random_transform(random, 0.1);
  const IntoUrdf into = cam.into(kRobot);
  EXPECT_EQ(into.joints[0].joint, "camera_joint");
  expect_camera_at(into.text, "camera_link",
                   cam.camera().estimate.T_parent_child * cam.camera().T_link_camera->inverse());
}

TEST(IntoUrdf, ALinkWithoutOpticalFrameIsTheBody) {
  const OneCamera cam("pole_camera");
  const std::string text =
      replaced(kRobot, "</robot>",
               "<joint name='pole' type='fixed'><parent link='base_link'/><child link='pole_camera'/></joint>"
               "<link name='pole_camera'/></robot>");
  const IntoUrdf into = cam.into(text);
  EXPECT_THAT(into.notes, testing::Contains(HasSubstr("below pole_camera is no optical frame")));
  Eigen::Matrix3d body_from_optical;
  body_from_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Rigid3 T_optical_body = Rigid3(Eigen::Quaterniond(body_from_optical), Eigen::Vector3d::Zero()).inverse();
  expect_camera_at(into.text, "pole_camera", cam.job.cameras[0].estimate.T_parent_child * T_optical_body);
}

// A mast that carries other things does not move with its camera; nor does a pair of cameras for one of them.
TEST(IntoUrdf, JointsOfSeveralCamerasAreApart) {
  const auto eye = [](const std::string& name) {
    return "<joint name='" + name + "_joint' type='fixed'><parent link='rig_mast'/><child link='" + name +
           "_optical'/></joint><link name='" + name + "_optical'/>";
  };
  const std::string text = replaced(kRobot, "</robot>",
                                    "<joint name='mast_joint' type='fixed'><parent link='base_link'/><child "
                                    "link='rig_mast'/></joint><link name='rig_mast'/>" +
                                        eye("rig_left") + eye("rig_right") + "</robot>");
  OneCamera cams("rig_left_optical");
  cams.job.cameras.push_back(cams.job.cameras[0]);
  cams.job.cameras[1].name = "right";
  cams.job.cameras[1].link = "rig_right_optical";
  cams.job.cameras[1].estimate.T_parent_child.translation.x() += 0.1;
  const IntoUrdf into = cams.into(text);
  ASSERT_EQ(into.joints.size(), 2U);
  EXPECT_EQ(into.joints[0].joint, "rig_left_joint");
  EXPECT_EQ(into.joints[1].joint, "rig_right_joint");
  expect_camera_at(into.text, "rig_left_optical", cams.job.cameras[0].estimate.T_parent_child);
  expect_camera_at(into.text, "rig_right_optical", cams.job.cameras[1].estimate.T_parent_child);
  for (ExportCamera& camera : cams.job.cameras) camera.joint = "mast_joint";
  EXPECT_THAT(cams.problem(text), HasSubstr("would change for cam, too"));
  // One camera below the joint of another: each is where it is, whichever comes first.
  cams.job.cameras[0].joint.clear();
  const IntoUrdf nested = cams.into(text);
  expect_camera_at(nested.text, "rig_left_optical", cams.job.cameras[0].estimate.T_parent_child);
  expect_camera_at(nested.text, "rig_right_optical", cams.job.cameras[1].estimate.T_parent_child);
}

TEST(IntoUrdf, FarMovesAreQuestioned) {
  EXPECT_THAT(OneCamera().into(kRobot).notes, testing::Contains(HasSubstr("is camera_color_optical_frame the frame")));
}

// ------------------------------------------------------------------------------------------------------------- xacro

const std::string kHalfTurns = "${-pi/2} 0 ${ -M_PI / 2 }";
const std::string kXacro =
    replaced(replaced(replaced(kRobot, "-1.5707963 0 -1.5707963", kHalfTurns), "<link name=\"camera_link\"/>",
                      "<xacro:include filename=\"$(find cameras)/d455.xacro\"/><link name=\"${ns}camera_link\"/>"),
             "link=\"camera_link\"/>\n  </joint>", "link=\"${ns}camera_link\"/>\n  </joint>");

TEST(IntoUrdf, XacroWithLiteralNumbersIsEdited) {
  const std::string text =
      replaced(replaced(kXacro, "camera_link\"/><child link=\"camera_color_frame",
                        "${ns}camera_link\"/><child link=\"camera_color_frame"),
               "camera_link\"/><child link=\"camera_depth", "${ns}camera_link\"/><child link=\"camera_depth");
  const OneCamera cam;
  const IntoUrdf into = cam.into(text);
  EXPECT_EQ(into.joints[0].child, "${ns}camera_link");
  expect_camera_at(replaced(into.text, kHalfTurns, "-1.57079632679489662 0 -1.57079632679489662"),
                   "camera_color_optical_frame", cam.job.cameras[0].estimate.T_parent_child);
}

TEST(IntoUrdf, ComputedOriginsAreRefusedWithWhatToDo) {
  const OneCamera cam;
  EXPECT_THAT(cam.problem(replaced(kRobot, "0.1  0 0.5", "${x} 0 0.5")),
              AllOf(HasSubstr("robot.urdf:5: joint camera_joint"), HasSubstr("xyz=\"${x} 0 0.5\""),
                    HasSubstr("--to xacro"), HasSubstr("${camera_link_xyz}")));
  EXPECT_THAT(cam.problem(replaced(kRobot, "0.01 0.02 0.03", "${d} 0 0")),
              AllOf(HasSubstr("joint camera_color_joint"), HasSubstr("expand the file first")));
  const std::string block = replaced(kRobot, "<origin   rpy='0 0.1 0'\n            xyz = \"0.1  0 0.5\" />",
                                     "<xacro:insert_block name=\"origin\"/>");
  EXPECT_THAT(cam.problem(block), HasSubstr("its origin is computed"));
}

// -------------------------------------------------------------------------------------------------------- bad files

TEST(IntoUrdf, WhatIsNoUrdfIsSaid) {
  const OneCamera cam;
  EXPECT_THAT(cam.problem("hello"), HasSubstr("robot.urdf"));
  EXPECT_THAT(cam.problem(""), HasSubstr("is no XML"));
  EXPECT_THAT(cam.problem(kRobot.substr(0, 700)), AllOf(HasSubstr("robot.urdf:"), HasSubstr("is no XML")));
  EXPECT_THAT(cam.problem("<?xml version='1.0'?>\n<sdf/>"), HasSubstr("robot.urdf:2: the outermost element is <sdf>"));
  EXPECT_THAT(cam.problem(std::string("\xff\xfe<\0r\0", 6)), HasSubstr("save it as UTF-8"));
  std::string deep = "<robot>";
  for (int i = 0; i < 200000; ++i) deep += "<xacro:if>";
  EXPECT_THAT(cam.problem(deep), HasSubstr("is no XML"));
}

TEST(IntoUrdf, LinksThatAreNotThereGetASuggestion) {
  EXPECT_THAT(OneCamera("camera_lnik").problem(kRobot),
              AllOf(HasSubstr("cam: "), HasSubstr("has no link camera_lnik"),
                    HasSubstr("did you mean \"camera_link\"?"), HasSubstr("camera_color_optical_frame")));
  OneCamera cam;
  cam.camera().estimate.parent = "base_footprnt";
  EXPECT_THAT(cam.problem(kRobot),
              AllOf(HasSubstr("did you mean \"base_footprint\"?"), HasSubstr("; --parent base_link gives poses in")));
  EXPECT_THAT(OneCamera("camera_lnik").problem(kRobot), HasSubstr("; --link cam=LINK names"));
  EXPECT_THAT(OneCamera().problem(replaced(kRobot, "<link name=\"camera_color_frame\"/>", "")),
              AllOf(HasSubstr("names the link camera_color_frame"), HasSubstr("not defined")));
}

TEST(IntoUrdf, JointsThatMoveAreNamed) {
  const std::string text = replaced(kRobot, "camera_joint\" type=\"fixed\"", "camera_joint\" type=\"continuous\"");
  EXPECT_THAT(OneCamera().problem(text),
              AllOf(HasSubstr("robot.urdf:5: joint camera_joint: is continuous"), HasSubstr("must be fixed")));
  EXPECT_THAT(OneCamera("head").problem(kRobot), HasSubstr("joint head_joint: is revolute"));
}

TEST(IntoUrdf, TreesThatAreNoneAreNamed) {
  const std::string twice = replaced(kRobot, "</robot>",
                                     "<joint name='again' type='fixed'><parent link='head'/><child "
                                     "link='camera_link'/></joint></robot>");
  EXPECT_THAT(OneCamera().problem(twice),
              AllOf(HasSubstr("joint again"), HasSubstr("child of joint camera_joint (line 5)")));
  const std::string loop = replaced(kRobot, "</robot>",
                                    "<joint name='back' type='fixed'><parent link='camera_link'/><child "
                                    "link='base_link'/></joint></robot>");
  EXPECT_THAT(OneCamera().problem(loop), HasSubstr("closes a loop"));
  const std::string apart = replaced(kRobot, "<parent link=\"base_link\"/>\n", "<parent link=\"head2\"/>\n");
  EXPECT_THAT(OneCamera().problem(apart), HasSubstr("they hang in trees of their own"));
  EXPECT_THAT(OneCamera("base_link").problem(kRobot), HasSubstr("cam"));
}

TEST(IntoUrdf, SeveralOpticalFramesAreAsked) {
  const std::string text = replaced(kRobot, "camera_depth_optical_frame\"/></joint>", "camera_rgb_optical\"/></joint>");
  EXPECT_THAT(OneCamera().problem(replaced(text, "camera_depth_optical_frame", "camera_rgb_optical")),
              AllOf(HasSubstr("several optical frames"), HasSubstr("camera_color_optical_frame, camera_rgb_optical")));
}

TEST(IntoUrdf, NumbersThatAreNoneAreNamed) {
  EXPECT_THAT(OneCamera().problem(replaced(kRobot, "0.01 0.02 0.03", "0.01 0.02")),
              AllOf(HasSubstr("joint camera_color_joint"), HasSubstr("xyz=\"0.01 0.02\""), HasSubstr("three numbers")));
  EXPECT_THAT(OneCamera().problem(replaced(kRobot, "0 0.1 0", "0 nan 0")), HasSubstr("joint camera_joint"));
  EXPECT_THAT(OneCamera().problem(
                  replaced(kRobot, "<parent link=\"base_link\"/>\n", "<origin/><parent link=\"base_link\"/>\n")),
              HasSubstr("has several origins"));
}

}  // namespace
}  // namespace rigproof
