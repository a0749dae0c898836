#!/usr/bin/env python3
"""Reads what scripts/sbom writes of the built program: the keys of SPDX 2.3, references that lead somewhere, every library
that the program asks for, what is compiled in, and the bundles of a report's page.
Usage: sbom.py SOURCE_FOLDER BUILD_FOLDER PROGRAM"""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE, BUILD, PROGRAM = map(Path, sys.argv[1:4])
# Of the list of SPDX, those that Debian's copyright files of today's libraries lead to.
LISTED = {"0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "BSL-1.0", "GPL-2.0-only", "GPL-2.0-or-later", "GPL-3.0-or-later",
          "LGPL-2.1-or-later", "LGPL-3.0-or-later", "MIT", "MPL-2.0", "X11", "Zlib"}


def run(*arguments, epoch="1700000000"):
    return subprocess.run([SOURCE / "scripts/sbom", *arguments], capture_output=True, text=True,
                          env={**os.environ, "SOURCE_DATE_EPOCH": epoch})


def installed(package):
    return subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True, check=True).stdout


class Sbom(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.file = Path(cls.folder.name, "sbom.json")
        made = run(BUILD, PROGRAM, "-o", cls.file, "--loads", "libegl1", "libgl1")
        assert made.returncode == 0, made.stderr
        cls.text = cls.file.read_text()
        cls.content = json.loads(cls.text)
        cls.packages = {package["SPDXID"]: package for package in cls.content["packages"]}
        cls.by_name = {package["name"]: package for package in cls.content["packages"]}

    def related(self, kind):
        return {relation["comment"]: self.packages[relation["relatedSpdxElement"]]
                for relation in self.content["relationships"] if relation["relationshipType"] == kind}

    def names(self, kind):
        return {self.packages[relation["relatedSpdxElement"]]["name"]
                for relation in self.content["relationships"] if relation["relationshipType"] == kind}

    def test_document_has_the_keys_of_spdx(self):
        self.assertEqual(set(self.content), {"spdxVersion", "dataLicense", "SPDXID", "name", "documentNamespace", "creationInfo",
                                             "packages", "relationships", "hasExtractedLicensingInfos"})
        self.assertEqual((self.content["spdxVersion"], self.content["dataLicense"], self.content["SPDXID"]),
                         ("SPDX-2.3", "CC0-1.0", "SPDXRef-DOCUMENT"))
        self.assertRegex(self.content["documentNamespace"], r"^urn:uuid:[0-9a-f-]{36}$")
        self.assertEqual(self.content["creationInfo"]["created"], "2023-11-14T22:13:20Z")
        self.assertRegex(self.content["creationInfo"]["creators"][0], r"^Tool: \S+$")

    def test_packages_have_the_keys_of_spdx(self):
        self.assertEqual(len(self.packages), len(self.content["packages"]), "identifiers are unique")
        defined = {info["licenseId"] for info in self.content["hasExtractedLicensingInfos"]}
        for info in self.content["hasExtractedLicensingInfos"]:
            self.assertRegex(info["licenseId"], r"^LicenseRef-[A-Za-z0-9.-]+$")
            self.assertGreater(len(info["extractedText"]), 20, info["licenseId"])
        for identifier, package in self.packages.items():
            self.assertRegex(identifier, r"^SPDXRef-[A-Za-z0-9.-]+$")
            self.assertFalse(package["filesAnalyzed"])
            self.assertEqual(package["downloadLocation"], "NOASSERTION")
            self.assertRegex(package["supplier"], r"^(Organization: .+|NOASSERTION)$")
            for licence in re.split(r" (?:AND|OR) ", package["licenseDeclared"]):
                self.assertIn(licence, LISTED | defined, identifier)
            for reference in package.get("externalRefs", []):
                self.assertEqual((reference["referenceCategory"], reference["referenceType"]), ("PACKAGE-MANAGER", "purl"))
                self.assertRegex(reference["referenceLocator"], r"^pkg:(deb/debian|npm)/[^@\s:]+@[^@\s:]+$")

    def test_relationships_lead_somewhere(self):
        for relation in self.content["relationships"]:
            self.assertIn(relation["relationshipType"], {"DESCRIBES", "DYNAMIC_LINK", "STATIC_LINK", "CONTAINS"})
            self.assertIn(relation["spdxElementId"], {"SPDXRef-DOCUMENT", "SPDXRef-rigproof"})
        related = {relation["relatedSpdxElement"] for relation in self.content["relationships"]}
        self.assertEqual(related, set(self.packages))

    def test_every_needed_library_is_covered(self):
        dump = subprocess.run(["readelf", "-d", PROGRAM], capture_output=True, text=True, check=True).stdout
        needed = set(re.findall(r"\(NEEDED\).*\[(.+)\]", dump))
        self.assertGreater(len(needed), 20)
        linked = self.related("DYNAMIC_LINK")
        self.assertEqual(needed, set(linked) - {"opened while it runs"})
        for package in linked.values():
            self.assertEqual(package["versionInfo"], installed(package["name"]))
            self.assertTrue(package["supplier"].startswith("Organization: "))
        self.assertEqual(linked["libcrypto.so.3"]["name"], "libssl3")
        self.assertEqual(linked["libcrypto.so.3"]["licenseDeclared"], "Apache-2.0")
        self.assertIn("libegl1", self.names("DYNAMIC_LINK"))

    def test_what_is_compiled_in_is_covered(self):
        self.assertEqual(self.names("STATIC_LINK"), {"libceres-dev"})
        inside = self.names("CONTAINS")
        self.assertLessEqual({"libeigen3-dev", "libcli11-dev", "libfmt-dev", "nlohmann-json3-dev"}, inside)
        self.assertFalse({"libgtest-dev", "libbenchmark-dev", "linux-libc-dev", "libopencv-core-dev"} & inside)

    def test_bundles_of_the_page_are_covered(self):
        files = (SOURCE / "study/report/page/third_party").glob("*.LICENSE.txt")
        for name in (file.name.split(".")[0] for file in files):
            self.assertIn(name, self.names("CONTAINS"))
        self.assertEqual(self.by_name["three"]["licenseDeclared"], "MIT")
        self.assertEqual(self.by_name["echarts"]["externalRefs"][0]["referenceLocator"],
                         f"pkg:npm/echarts@{self.by_name['echarts']['versionInfo']}")

    def test_the_same_build_gives_the_same_bytes(self):
        again = Path(self.folder.name, "again.json")
        self.assertEqual(run(BUILD, PROGRAM, "-o", again, "--loads", "libegl1", "libgl1").returncode, 0)
        self.assertEqual(again.read_text(), self.text)

    def test_says_what_is_wrong(self):
        nothing = Path(self.folder.name, "nothing")
        for arguments, said in (((BUILD, nothing), "no such file"), ((nothing, PROGRAM), "no such file"),
                                ((BUILD, BUILD / "build.ninja"), "readelf"),
                                ((BUILD, PROGRAM, "--loads", "no-such-package"), "no-such-package")):
            output = Path(self.folder.name, "wrong.json")
            made = run(*arguments[:2], "-o", output, *arguments[2:])
            self.assertEqual(made.returncode, 2)
            self.assertIn(said, made.stderr)
            self.assertFalse(output.exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
