"""The extension for VS Code: thin, consistent with what the server reads, and it starts the server."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import pytest

from plcgen import __version__
from plcgen.s7.cpu.sources import SUFFIXES
from tests.projects import ROOT
from tests.workbench.desk import Desk

FOLDER = ROOT / "docs" / "editors" / "vscode"
PACKAGE: dict[str, Any] = json.loads((FOLDER / "package.json").read_text("utf-8"))
CODE = (FOLDER / "extension.js").read_text("utf-8")
SNIPPETS: dict[str, Any] = json.loads((FOLDER / "specs.code-snippets").read_text("utf-8"))


def test_languages_are_sources() -> None:
    """Every ending that the extension contributes is one that the server reads."""
    (language,) = PACKAGE["contributes"]["languages"]
    assert {".scl", ".udt", ".db"} < set(language["extensions"]) <= SUFFIXES
    assert __version__.startswith(PACKAGE["version"])


def test_the_command_belongs_to_the_machine() -> None:
    """A folder that somebody else made cannot say which program is started, and no shell reads any name."""
    setting = PACKAGE["contributes"]["configuration"]["properties"]["plcgen.command"]
    assert setting["scope"] == "machine"
    assert not re.search(r"\bexec\(|\bspawn\(|shell\s*:|ShellExecution|enableScripts: true", CODE)


def _filled(body: list[str]) -> str:
    text = "\n".join(body).replace("$0", "")
    text = re.sub(r"\$\{\d+\|([^,|]+)[^}]*\}", r"\1", text)
    return re.sub(r"\$\{\d+:([^}]*)\}", r"\1", text)


def test_snippets_are_right(tmp_path: Path) -> None:
    """Filled in as they stand, all of them together are a spec without an error."""
    texts = {snippet["prefix"]: _filled(snippet["body"]) for snippet in SNIPPETS.values()}
    spec = texts.pop("plcgen-spec").rstrip() + "\n"
    drive = texts.pop("plcgen-drive").rstrip().replace("\n", "\n  ")
    spec = spec.replace("\njobs:", f"  {drive}\n\njobs:").replace("\n\n  fan", "\n  fan")
    for text in texts.values():
        spec += "  " + text.rstrip().replace("\n", "\n  ") + "\n"
    desk = Desk(tmp_path)
    document, *_ = desk.open(spec)
    found = [one.diagnostic for one in desk.workspace.diagnostics(document)]
    assert not [one for one in found if one.severity.name == "ERROR"]
    assert len(desk.workspace.outline(document)[-1].children) == 1 + len(texts)


_DRIVER = """
const path = require("node:path"), Module = require("node:module");
const said = {commands: [], clients: [], shown: []};
const nothing = () => ({dispose() {}});
const vscode = {
  workspace: {
    getConfiguration: () => ({get: () => ["python", "-m", "plcgen"]}), createFileSystemWatcher: nothing,
    onDidChangeConfiguration: nothing, textDocuments: [
      {uri: {scheme: "file", fsPath: "/w/a.yaml"}, languageId: "yaml", getText: () => "plc: {}"},
      {uri: {scheme: "file", fsPath: "/w/b.yaml"}, languageId: "yaml", getText: () => "services: {}"},
    ],
    workspaceFolders: [{uri: {fsPath: "/w"}}], getWorkspaceFolder: () => ({uri: {fsPath: "/w"}}),
  },
  tasks: {registerTaskProvider: (kind, provider) => { said.tasks = provider; return nothing(); }},
  commands: {registerCommand: (name) => { said.commands.push(name); return nothing(); }},
  window: {showErrorMessage: (text) => said.shown.push(text)},
  TaskScope: {Workspace: 2},
  ProcessExecution: class { constructor(program, args) { this.run = [program, ...args]; } },
  Task: class { constructor(definition, scope, name, source, run) { Object.assign(this, {definition, name, run}); } },
};
class LanguageClient {
  constructor(id, name, server) { said.clients.push([server.run.command, ...server.run.args]); }
  async start() {}
  needsStop() { return false; }
}
const load = Module._load;
Module._load = (name, ...rest) =>
  name === "vscode" ? vscode : name === "vscode-languageclient/node" ? {LanguageClient} : load(name, ...rest);
const extension = require(path.resolve(process.argv[2]));
extension.activate({subscriptions: [], globalStorageUri: {fsPath: "/tmp"}}).then(() => {
  const asked = said.tasks.provideTasks().map((task) => [task.name, ...task.run.run]);
  const bad = said.tasks.resolveTask({definition: {verb: "generate", spec: "--force"}});
  console.log(JSON.stringify({...said, tasks: asked, bad: bad === undefined}));
});
"""


def test_it_starts_the_server(tmp_path: Path) -> None:
    """In a VS Code of straw: the server, the tasks of the specs that are open, and the commands it contributes."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    driver = tmp_path / "driver.js"
    driver.write_text(_DRIVER, "utf-8")
    done = subprocess.run([node, driver, FOLDER / "extension.js"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    start = ["python", "-m", "plcgen"]
    assert said["clients"] == [[*start, "lsp"]]
    assert set(said["commands"]) == {one["command"] for one in PACKAGE["contributes"]["commands"]}
    verbs = PACKAGE["contributes"]["taskDefinitions"][0]["properties"]["verb"]["enum"]
    assert said["tasks"] == [[f"{verb} a.yaml", *start, verb, "a.yaml"] for verb in verbs]
    assert said["bad"]
    assert said["shown"] == []


def test_what_was_built() -> None:
    """The package holds the extension, its licence, and what it needs to run; nothing of the repository besides."""
    built = os.environ.get("PLCGEN_VSIX")
    if not built:
        pytest.skip("make vsix builds it; .ci/run does, if npm is there")
    with zipfile.ZipFile(built) as archive:
        names = archive.namelist()
        assert archive.read("extension/extension.js").decode() == CODE
    own = {name for name in names if name.startswith("extension/") and "/node_modules/" not in name}
    assert own == {
        f"extension/{name}"
        for name in ("LICENSE.txt", "extension.js", "package.json", "scl.json", "specs.code-snippets")
    }
    assert any(name.startswith("extension/node_modules/vscode-languageclient/") for name in names)
    assert sum(1 for _ in names) < 400
