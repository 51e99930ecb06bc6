# SPDX-License-Identifier: BSD-3-Clause
"""xacro files as robots, by the package xacro itself: arguments, includes, packages, failures. (With stand-ins: tests/cli/xacro_test.cpp.)"""
import os
import pathlib
import subprocess
import sys

import numpy
import pytest

import leeway

HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
ARM = HEAD + '''
  <xacro:arg name="joints" default="2"/>
  <xacro:property name="reach" value="${0.5 * 0.8}"/>
  <xacro:macro name="chain" params="left at">
    <link name="link${at}"><collision><geometry><sphere radius="${0.1 / (at + 1)}"/></geometry></collision></link>
    <joint name="joint${at}" type="revolute"><parent link="link${at - 1}"/><child link="link${at}"/><origin xyz="${reach} 0 0"/>
      <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    <xacro:if value="${left > 1}"><xacro:chain left="${left - 1}" at="${at + 1}"/></xacro:if>
  </xacro:macro>
  <link name="link0"><collision><geometry><mesh filename="base.stl"/></geometry></collision></link>
  <xacro:chain left="$(arg joints)" at="1"/>
</robot>
'''


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a xacro file and its mesh. The xacro of this interpreter's environment is on $PATH."""
    monkeypatch.setenv("PATH", f"{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}")
    monkeypatch.delenv("LEEWAY_XACRO", raising=False)
    (tmp_path / "arm.urdf.xacro").write_text(ARM)
    write_mesh(tmp_path / "base.stl")
    return tmp_path


def write_mesh(file):
    """A tetrahedron, as text."""
    corners = numpy.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
    file.parent.mkdir(parents=True, exist_ok=True)
    facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners[list(face)]) + "endloop\nendfacet\n"
        for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)))
    file.write_text(f"solid t\n{facets}endsolid t\n")


def test_arguments_change_the_robot_and_meshes_are_beside_the_file(folder):
    two = leeway.Robot(folder / "arm.urdf.xacro", xacro={})
    four = leeway.Robot(folder / "arm.urdf.xacro", xacro={"joints": 4})
    assert two.default_state().shape == (2,)
    assert four.default_state().shape == (4,)
    assert numpy.allclose(four.fk(numpy.zeros(4))[:, 0, 3], [0, 0.4, 0.8, 1.2, 1.6])
    assert any("was expanded by" in line for line in two.notices)
    assert two.collision["link0"][0][0].type == "mesh"


def test_nothing_runs_without_being_asked(folder):
    with pytest.raises(leeway.InputError, match="this is a xacro file; add xacro=.*run xacro first"):
        leeway.Robot(folder / "arm.urdf.xacro")
    (folder / "plain.urdf").write_text('<robot name="r"><link name="a"><collision><geometry><sphere radius="1"/></geometry></collision></link></robot>')
    with pytest.raises(leeway.InputError, match="is no xacro file"):
        leeway.Robot(folder / "plain.urdf", xacro={})
    with pytest.raises(leeway.InputError, match="in a stream.*save it as a file"):
        leeway.Robot(stream(), xacro={})


def stream():
    """A xacro file as a stream that this program was started with."""
    read, write = os.pipe()
    os.write(write, ARM.encode())
    os.close(write)
    return f"/dev/fd/{read}"


def test_a_failure_of_xacro_is_told_with_its_words(folder):
    (folder / "bad.xacro").write_text(HEAD + '<link name="${no_such_symbol}"/></robot>')
    with pytest.raises(leeway.InputError, match="bad.xacro: xacro: .*failed with exit status .*no_such_symbol.*correct the file"):
        leeway.Robot(folder / "bad.xacro", xacro={"side": "left"})
    with pytest.raises(leeway.InputError, match="argument two words:=1: is none of xacro"):
        leeway.Robot(folder / "arm.urdf.xacro", xacro={"two words": 1})


LINK = '<link name="a"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>'
JOINT = '<link name="b"/><joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="{}" upper="1"/></joint>'
MACRO = '<xacro:macro name="m" params="{}">{}</xacro:macro>'

DAMAGED = {  # file: words of the message, beside the name of the file and a remedy
    HEAD + LINK[:30]: "line 1: not well-formed XML",
    HEAD + "<xacro:if>" + LINK + "</robot>": "line 1: not well-formed XML",
    "<robot name='r'>" + LINK + "<xacro:no/></robot>": "<xacro:no> .line 1.: .*declare xacro's namespace; write <robot xmlns:xacro",
    HEAD + LINK + "<xacro:no_such_macro/></robot>": "unknown macro name: xacro:no_such_macro",
    HEAD + MACRO.format("x", "<link name='${x}'/>") + LINK + "<xacro:m/></robot>": r"Undefined parameters \[x\] when instantiating macro: m",
    HEAD + MACRO.format("x", "<link name='${x}'/>") + LINK + "<xacro:m x='1' y='2'/></robot>": 'Invalid parameter "y" when instantiating macro: m',
    HEAD + MACRO.format("*o", "<link name='x'/>") + LINK + "<xacro:m/></robot>": "Not enough blocks when instantiating macro: m",
    HEAD + MACRO.format("", "<xacro:m/>") + LINK + "<xacro:m/></robot>": "recursion depth exceeded.*macro: m",
    HEAD + LINK + '<link name="${1 +}"/></robot>': "when evaluating expression '1 .'",
    HEAD + LINK + '<link name="${1 + 2"/></robot>': r"invalid expression: \$\{1 . 2",
    HEAD + LINK + '<link name="l${1/0}"/></robot>': "division by zero *when evaluating expression '1/0'",
    HEAD + '<xacro:include filename="parts/nowhere.xacro"/>' + LINK + "</robot>": "No such file or directory: .*parts/nowhere.xacro",
    HEAD + '<xacro:include filename="broken.xacro"/>' + LINK + "</robot>": "line 1, column .*broken.xacro included from",
    HEAD + LINK + '<link name="$(arg side)"/></robot>': "Undefined substitution argument side",
    HEAD + LINK + '<link name="$(fnd package)"/></robot>': r"Unknown substitution command \[fnd package\]",
    HEAD + LINK + '<link name="$(env NOBODY_SET_THIS)"/></robot>': "environment variable 'NOBODY_SET_THIS' is not set",
    HEAD + LINK + '<xacro:property name="x" value="${y}"/><xacro:property name="y" value="${x}"/><link name="${x}"/></robot>': "circular variable definition: x",
    HEAD + LINK + '<xacro:if value="perhaps"><link name="b"/></xacro:if></robot>': 'conditional "perhaps"',
    HEAD + LINK + "<link name=\"${xacro.load_yaml('no.yaml')}\"/></robot>": "No such file or directory: .*no.yaml",
    HEAD + LINK + '<link name="b"><xacro:insert_block name="nothing"/></link></robot>': 'Undefined block "nothing"',
    HEAD + LINK + JOINT.format("${'left'}") + "</robot>": "joint j .line .* of the text that xacro wrote: lower=.left. of <limit>: .*not a number; write",
    HEAD + LINK + JOINT.format("${float('nan')}") + "</robot>": "joint j .line .* of the text that xacro wrote: .*not finite; write",
    HEAD + MACRO.format("", LINK) + "<xacro:m/><xacro:m/></robot>": "link a .line .* of the text that xacro wrote: .*defined before; rename",
    HEAD + '<xacro:property name="x" value="1"/></robot>': "has no link: it may define macros only; name the file",
}


@pytest.mark.parametrize("text", DAMAGED, ids=range(len(DAMAGED)))
def test_damaged_files_are_refused_with_their_place(folder, text):
    (folder / "broken.xacro").write_text(HEAD + "<link")
    (folder / "bad.urdf.xacro").write_text(text)
    with pytest.raises(leeway.InputError, match="(?s)bad.urdf.xacro: .*" + DAMAGED[text]) as raised:
        leeway.Robot(folder / "bad.urdf.xacro", xacro={})
    assert raised.value.file.endswith("bad.urdf.xacro") and raised.value.element and raised.value.remedy


def test_bytes_that_are_no_text_are_shown(folder):
    (folder / "bytes.xacro").write_bytes((HEAD + LINK).encode() + b"<link name='\xff\xfe'/></robot>")
    with pytest.raises(leeway.InputError, match="bytes.xacro: ") as raised:
        leeway.Robot(folder / "bytes.xacro", xacro={})
    assert raised.value.remedy


def test_packages_are_found_as_those_of_meshes(folder):
    package = folder / "clone" / "robot"
    (package / "urdf").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>arm_description</name></package>")
    (package / "urdf" / "parts.xacro").write_text(ARM)
    write_mesh(package / "urdf" / "base.stl")
    main = package / "urdf" / "main.xacro"
    main.write_text(HEAD + '<xacro:include filename="$(find arm_description)/urdf/parts.xacro"/></robot>')
    assert leeway.Robot(main, xacro={}).default_state().shape == (2,), "a package.xml upwards has the name"
    elsewhere = folder / "elsewhere.xacro"
    elsewhere.write_text(main.read_text())
    with pytest.raises(leeway.InputError, match="package arm_description was not found; give --package-path arm_description=FOLDER"):
        leeway.Robot(elsewhere, xacro={})
    for packages in ([f"arm_description={package}"], [str(folder / "by_name")]):
        (folder / "by_name").mkdir(exist_ok=True)
        if not (folder / "by_name" / "arm_description").exists():
            (folder / "by_name" / "arm_description").symlink_to(package)
        assert leeway.Robot(elsewhere, xacro={}, packages=packages).default_state().shape == (2,)


def test_the_interpreter_is_asked_where_the_path_has_none(folder, monkeypatch):
    monkeypatch.setenv("PATH", "/nowhere")
    assert leeway.Robot(folder / "arm.urdf.xacro", xacro={}).default_state().shape == (2,)


def test_the_program_and_python_read_the_same(folder):
    program = os.environ.get("LEEWAY_PROGRAM")
    if not program:
        pytest.skip("LEEWAY_PROGRAM names no program: this build has none")
    call = [program, "info", "--robot", "arm.urdf.xacro", "joints:=3", "--no-cache"]
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "joint3" in done.stdout and "joint4" not in done.stdout
    assert "was expanded by" in done.stderr


def test_missing_meshes_are_left_out_on_request(folder):
    (folder / "base.stl").unlink()
    with pytest.raises(leeway.InputError, match="base.stl was not found"):
        leeway.Robot(folder / "arm.urdf.xacro", xacro={})
    robot = leeway.Robot(folder / "arm.urdf.xacro", xacro={}, missing_meshes="skip")
    assert any("LEFT OUT" in line and "base.stl of link link0" in line for line in robot.notices)
    with pytest.raises(ValueError, match="give 'refuse' or 'skip'"):
        leeway.Robot(folder / "arm.urdf.xacro", missing_meshes="ignore")
