"use strict";
// Starts `rvmon lsp`. Without the client's package, colours and problem matchers work all the same.

const vscode = require("vscode");

let client;

async function activate(context) {
  let node;
  try {
    node = require("vscode-languageclient/node");
  } catch {
    vscode.window.showInformationMessage(
      `rvmon: for findings while you type run "npm install --omit=dev" in ${context.extensionPath}`,
    );
    return;
  }
  const command = vscode.workspace.getConfiguration("rvmon").get("command");
  client = new node.LanguageClient(
    "rvmon",
    "rvmon",
    { command, args: ["lsp"], transport: node.TransportKind.stdio },
    { documentSelector: [{ language: "rv" }] },
  );
  await client.start();
}

function deactivate() {
  return client?.stop();
}

module.exports = { activate, deactivate };
