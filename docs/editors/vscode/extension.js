// Starts `plcgen lsp`, runs verbs as tasks, shows the review page. What a spec or a source means is for the server to say.
"use strict";

const { execFile } = require("node:child_process");
const fs = require("node:fs");
const path = require("node:path");
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

const VERBS = ["check", "generate", "verify"];
const SOURCES = "**/*.{yaml,yml,csv,scl,udt,db,awl,s7dcl,s7res}";
const MOST = 64 * 1024 * 1024;
let client;

function command() {
  const [program, ...first] = vscode.workspace.getConfiguration("plcgen").get("command");
  return { program, first };
}

function newClient() {
  const { program, first } = command();
  const server = { command: program, args: [...first, "lsp"] };
  const documentSelector = [
    { scheme: "file", language: "yaml" },
    { scheme: "file", language: "scl" },
  ];
  const synchronize = { fileEvents: vscode.workspace.createFileSystemWatcher(SOURCES) };
  return new LanguageClient("plcgen", "plcgen", { run: server, debug: server }, { documentSelector, synchronize });
}

async function start() {
  client = newClient();
  try {
    await client.start();
  } catch (problem) {
    const told = `plcgen does not start (${problem.message}): pip install pygls, or set plcgen.command`;
    vscode.window.showErrorMessage(told);
  }
}

async function stop() {
  const old = client;
  client = undefined;
  if (old !== undefined && old.needsStop()) {
    await old.stop();
  }
}

function isSpec(document) {
  return document.uri.scheme === "file" && document.languageId === "yaml" && /^(plc|include)\s*:/m.test(document.getText());
}

function taskOf(definition, scope) {
  const { program, first } = command();
  const run = new vscode.ProcessExecution(program, [...first, definition.verb, definition.spec]);
  return new vscode.Task(definition, scope, `${definition.verb} ${definition.spec}`, "plcgen", run, []);
}

const tasks = {
  provideTasks() {
    const folder = vscode.workspace.workspaceFolders?.[0];
    const open = vscode.workspace.textDocuments.filter(isSpec);
    return open.flatMap((document) => {
      const scope = vscode.workspace.getWorkspaceFolder(document.uri) ?? folder ?? vscode.TaskScope.Workspace;
      const spec = scope.uri ? path.relative(scope.uri.fsPath, document.uri.fsPath) : document.uri.fsPath;
      return VERBS.map((verb) => taskOf({ type: "plcgen", verb, spec }, scope));
    });
  },
  resolveTask(task) {
    const { verb, spec } = task.definition;
    const known = VERBS.includes(verb) && typeof spec === "string" && !spec.startsWith("-");
    return known ? taskOf(task.definition, task.scope ?? vscode.TaskScope.Workspace) : undefined;
  },
};

// The page is shown without scripts: it comes from files that may be anybody's.
function review(storage) {
  const document = vscode.window.activeTextEditor?.document;
  if (document === undefined || !isSpec(document)) {
    vscode.window.showInformationMessage("plcgen: open a spec first");
    return undefined;
  }
  const { program, first } = command();
  fs.mkdirSync(storage, { recursive: true });
  const page = path.join(storage, "review.html");
  const asked = [...first, "review", document.uri.fsPath, "--faults", "none", "--output", page, "--force"];
  const progress = { location: vscode.ProgressLocation.Notification, title: "plcgen review" };
  return vscode.window.withProgress(progress, () => new Promise((resolve) => {
    fs.rmSync(page, { force: true });
    execFile(program, asked, { maxBuffer: MOST }, (problem, _out, said) => {
      if (fs.existsSync(page)) {
        const panel = vscode.window.createWebviewPanel("plcgen.review", "Review", vscode.ViewColumn.Beside, {
          enableScripts: false, localResourceRoots: [],
        });
        panel.webview.html = fs.readFileSync(page, "utf8");
      } else {
        vscode.window.showErrorMessage(`plcgen review: ${said.trim().slice(0, 600) || problem?.message}`);
      }
      resolve();
    });
  }));
}

async function activate(context) {
  context.subscriptions.push(
    vscode.tasks.registerTaskProvider("plcgen", tasks),
    vscode.commands.registerCommand("plcgen.review", () => review(context.globalStorageUri.fsPath)),
    vscode.commands.registerCommand("plcgen.restart", async () => {
      await stop();
      await start();
    }),
    vscode.workspace.onDidChangeConfiguration(async (change) => {
      if (change.affectsConfiguration("plcgen.command")) {
        await stop();
        await start();
      }
    }),
  );
  await start();
}

module.exports = { activate, deactivate: stop };
