// Opened as a file, a page may neither fetch the index of the search nor start a worker. So the index is a script
// (INDEX is replaced by it), and what the worker would do is done in a frame that speaks the worker's language.
var __search = { index: Promise.resolve(INDEX) };
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      this.waiting = [];
      addEventListener("message", (event) => {
        if (event.source === this.frame.contentWindow) this.dispatchEvent(new MessageEvent("message", { data: event.data }));
      });
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.documentElement.append(this.frame);
      const inside = this.frame.contentWindow;
      const page = inside.document;
      page.open();
      page.write(`<script>
        const send = parent.postMessage.bind(parent);
        postMessage = (data) => send(data, "*");
        importScripts = (...urls) => urls.reduce((before, url) => before.then(() => new Promise((loaded) => {
          const script = document.createElement("script");
          script.src = url;
          script.onload = loaded;
          document.head.append(script);
        })), Promise.resolve());
      <\/script><script src="${url}"><\/script>`);
      page.close();
      inside.addEventListener("load", () => {
        this.ready = true;
        this.waiting.forEach((data) => this.postMessage(data));
      });
    }
    postMessage(data) {
      if (!this.ready) this.waiting.push(data);
      else this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data }));
    }
    terminate() {
      this.frame.remove();
    }
  };
}
